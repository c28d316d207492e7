"""Follows branches of limit cycles over a parameter by pseudo-arclength continuation.

The branch is a curve in the space of section point and parameter. Each step predicts along the
tangent and corrects by Newton's method perpendicular to it. The branch is therefore followed
through folds, where a stable and an unstable cycle meet and both disappear.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from furuta.limit_cycles.friction_loop import FrictionLoop
from furuta.limit_cycles.limit_cycle import limit_cycle
from furuta.limit_cycles.periodic_orbit import REST, REST_STEP, LimitCycle, Section, periodic_orbit
from furuta.limit_cycles.smooth_motion import CLOSEST, FURTHER
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI_DOT

FIRST_STEP = 0.02  # along the scaled curve, where the range of the parameter is 1
LARGEST_STEP = 0.05
SMALLEST_STEP = 1e-6
AT_EDGE = 1e-3  # of the range; the parameter may not be allowed beyond its ends
MAX_POINTS = 400
NEWTON_STEPS = 8
HOMOCLINIC = 0.01  # least distance of the last cycle from a rest, relative to its amplitude
TOLERANCE = 1e-7  # scaled residual of a corrected point
STARTS = 9  # values at which a cycle is looked for, if there is none to start from
PARAMETER_STEP = 1e-6  # of the finite difference, relative to the range


class BranchPoint(NamedTuple):
    """A cycle on the branch; of a joint it is in the joint's units.

    ``event``: fold (the parameter reverses: a stable and an unstable cycle meet and disappear),
    vanishes (the amplitude goes to zero), homoclinic (the period grows without bound, because the
    cycle comes ever closer to an unstable rest), end (of the range), lost (could not be followed).
    """

    value: float
    cycle: Any
    event: str = ""


class Branch:
    """Follows the cycle of ``loop_at(value)`` while the parameter is within [low, high]."""

    def __init__(self, loop_at: Callable[[float], FrictionLoop], low: float, high: float) -> None:
        if not low < high:
            raise ParameterError(f"the range must have low < high, given {low:g} to {high:g}")
        self._loop_at = loop_at
        self._low, self._range = low, high - low

    def follow(self, value: float, cycle: LimitCycle) -> list[BranchPoint]:
        """The whole branch through ``cycle``, found at ``value``, in order along the curve."""
        if cycle.kind != "limit_cycle":
            raise ParameterError(f"there is no limit cycle at {value:g} to follow: {cycle.kind}")
        if not np.isfinite(cycle.period_s):
            raise ParameterError(
                f"the cycle at {value:g} cannot be followed: its period is infinite, because the "
                "arm creeps to an unstable rest"
            )
        if cycle.point[PHI_DOT] != 0.0:
            raise ParameterError(f"the cycle at {value:g} cannot be followed: it never reverses")
        self._turns, self._side = cycle.turns, cycle.side
        usual = Section(self._loop_at(value)).smallest
        self._smallest = cycle.smallest_slide if cycle.smallest_slide < usual else None
        start = self._pack(value, cycle)
        backward, forward = self._one_way(start, -1.0), self._one_way(start, 1.0)
        return _with_folds([*reversed(backward), BranchPoint(value, cycle), *forward])

    def _one_way(self, start: np.ndarray, direction: float) -> list[BranchPoint]:
        points: list[BranchPoint] = []
        w, step = start, FIRST_STEP
        tangent = np.zeros_like(w)
        tangent[-1] = direction
        tangent = self._tangent(w, tangent)
        while len(points) < MAX_POINTS:
            corrected = self._correct(w + step * tangent, tangent)
            point = self._point(corrected) if corrected is not None else None
            if corrected is None or point is None:
                step *= 0.5
                if step < SMALLEST_STEP:
                    return self._ended(points, self._ending(w, points))
                continue
            if not 0.0 <= corrected[-1] <= 1.0:
                last = self._at_edge(w, corrected)
                return self._ended([*points, last] if last else points, "end")
            next_tangent = self._tangent(corrected, tangent)
            points.append(point)
            if point.cycle.phi_peak_to_peak_rad < 10 * REST:
                return self._ended(points, "vanishes")
            cosine = float(next_tangent @ tangent)
            w, tangent = corrected, next_tangent
            step = min(LARGEST_STEP, step * (1.5 if cosine > 0.98 else 0.6))
        return self._ended(points, "lost")

    def _at_edge(self, inside: np.ndarray, outside: np.ndarray) -> BranchPoint | None:
        """The cycle at the end of the range between two points of the branch."""
        edge = 0.0 if outside[-1] < 0.0 else 1.0
        fraction = (edge - inside[-1]) / (outside[-1] - inside[-1])
        w = inside + fraction * (outside - inside)
        w[-1] = edge
        return self._point(w)

    @staticmethod
    def _ending(w: np.ndarray, points: list[BranchPoint]) -> str:
        """Why the branch cannot be followed beyond ``w``."""
        if min(w[-1], 1.0 - w[-1]) < AT_EDGE:
            return "end"
        last = points[-1].cycle if points else None
        if last and last.rest_distance < HOMOCLINIC * last.phi_peak_to_peak_rad:
            return "homoclinic"
        return "lost"

    @staticmethod
    def _ended(points: list[BranchPoint], event: str) -> list[BranchPoint]:
        if points:
            points[-1] = points[-1]._replace(event=points[-1].event or event)
        return points

    def _pack(self, value: float, cycle: LimitCycle) -> np.ndarray:
        """Scaled coordinates: section point of order 1, parameter between 0 and 1."""
        section = self._section(value)
        self._scale = np.ones(len(section.free))
        if section.loop.law.bristle:
            self._scale[-1] = 1.0 / section.loop.law.parameters.sigma0
        s = np.array(cycle.point)[section.free] / self._scale
        return np.append(s, (value - self._low) / self._range)

    def _section(self, value: float) -> Section:
        return Section(self._loop_at(value), self._smallest, self._side)

    def _closest(self, w: np.ndarray) -> float:
        """Least distance from a rest of the motion that starts at ``w``."""
        section = self._section(float(self._low + w[-1] * self._range))
        end = section.follow(section.state(w[:-1] * self._scale), turns=self._turns)
        return float(end.extent[FURTHER, CLOSEST])

    def _residual(self, w: np.ndarray) -> np.ndarray | None:
        try:
            section = self._section(float(self._low + w[-1] * self._range))
        except ParameterError:
            return None
        s = w[:-1] * self._scale
        end = section.map(s, self._turns)
        return None if end is None else (end - s) / self._scale

    def _jacobian(self, w: np.ndarray) -> np.ndarray | None:
        columns = []
        step = min(PARAMETER_STEP, REST_STEP * self._closest(w))
        for i in range(len(w)):
            d = np.zeros_like(w)
            d[i] = step * (0.1 if i < len(w) - 1 else 1.0)
            ahead, behind = self._residual(w + d), self._residual(w - d)
            if ahead is None or behind is None:
                return None
            columns.append((ahead - behind) / (2 * d[i]))
        return np.array(columns).T

    def _tangent(self, w: np.ndarray, along: np.ndarray) -> np.ndarray:
        """Unit tangent of the branch at ``w``, in the direction of ``along``."""
        jacobian = self._jacobian(w)
        if jacobian is None:
            return along
        direction = np.linalg.svd(jacobian)[2][-1]
        return direction * np.sign(direction @ along or 1.0)

    def _correct(self, w: np.ndarray, tangent: np.ndarray) -> np.ndarray | None:
        guess = w
        for _ in range(NEWTON_STEPS):
            residual = self._residual(w)
            if residual is None:
                return None
            if np.linalg.norm(residual) < min(TOLERANCE, REST_STEP * self._closest(w)):
                return w
            jacobian = self._jacobian(w)
            if jacobian is None:
                return None
            system = np.vstack([jacobian, tangent])
            try:
                w = w - np.linalg.solve(system, np.append(residual, tangent @ (w - guess)))
            except np.linalg.LinAlgError:
                return None
        return None

    def _point(self, w: np.ndarray) -> BranchPoint | None:
        value = float(self._low + w[-1] * self._range)
        section = self._section(value)
        size = max(float(np.linalg.norm(w[:-1])), 1e-3)
        cycle = periodic_orbit(section, w[:-1] * self._scale, self._turns, size)
        return None if cycle is None else BranchPoint(value, cycle)


def _with_folds(points: list[BranchPoint]) -> list[BranchPoint]:
    """Mark the points where the parameter reverses along the branch."""
    marked = list(points)
    for i in range(1, len(points) - 1):
        before, here, after = (points[j].value for j in (i - 1, i, i + 1))
        if (here - before) * (after - here) < 0.0:
            marked[i] = points[i]._replace(event="fold")
    return marked


def follow_branch(
    loop_at: Callable[[float], FrictionLoop],
    low: float,
    high: float,
    here: float | None = None,
    cycle: LimitCycle | None = None,
) -> list[BranchPoint]:
    """The branch through ``cycle`` at the value ``here``, if that is within the range.

    Otherwise the branch through the cycle nearest to the middle of the range.

    Raises:
        ParameterError: There is no cycle with a finite period to follow.
    """
    branch = Branch(loop_at, low, high)
    if here is not None and cycle is not None and low <= here <= high:
        return branch.follow(here, cycle)
    values = np.linspace(low, high, STARTS)
    motions = []
    for value in sorted(values.tolist(), key=lambda value: abs(value - values[STARTS // 2])):
        cycle = limit_cycle(loop_at(value))
        if cycle.kind == "limit_cycle" and np.isfinite(cycle.period_s):
            return branch.follow(value, cycle)
        motions.append(f"{cycle.kind} at {value:g}")
    raise ParameterError(f"no limit cycle with a finite period to follow: {', '.join(motions)}")


def fold_value(branch: list[BranchPoint], index: int, size: str) -> float:
    """The parameter at a fold: the vertex of the parabola through its three points.

    ``size`` is the field of a cycle that measures it.
    """
    three = branch[index - 1 : index + 2]
    sizes = [getattr(point.cycle, size) for point in three]
    a, b, c = np.polyfit(sizes, [point.value for point in three], 2)
    return float(c - b * b / (4 * a))
