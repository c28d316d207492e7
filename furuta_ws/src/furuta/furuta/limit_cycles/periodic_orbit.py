"""Periodic orbits of a loop with friction as fixed points of its Poincaré map P.

The section is the joint's upper reversal, v = 0 from above; of a motion that never slides forward
the lower one, v = 0 from below. There the state has n free coordinates: all but v, without the
bristle where there is none, and without a position on which nothing depends. P leads from one such
reversal to the next.

A periodic motion satisfies s = P(s). Newton's method finds it, stable or not. Its Floquet
multipliers are the eigenvalues of dP/ds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

import numpy as np

from furuta.limit_cycles.exact_motion import follow_to_reversal
from furuta.limit_cycles.friction_loop import (
    BRISTLE,
    FrictionLoop,
    control,
    friction_at,
    next_mode,
    smallest_slide,
)
from furuta.limit_cycles.linear_loop import LinearLoop
from furuta.limit_cycles.smooth_motion import (
    CLOSEST,
    EVENT,
    FURTHER,
    HIGH,
    LOW,
    NEAR,
    STUCK,
    extent_at,
)
from furuta.results.result import Result
from furuta.results.text import angle, swing_sentence, values_text
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, THETA

MAX_TRACE = 200_000  # rows between two upper reversals
REST = 1e-7  # [rad] peak to peak below which the arm is at rest
TOLERANCE = 1e-9  # Newton correction, relative to the size of the cycle
NEWTON_STEPS = 25
DIFFERENCE_STEP = 1e-6  # of the finite differences, relative to the size of the cycle
DIFFERENCE_PARTS = (1.0, 0.1, 0.01)  # of that step, for the multipliers
# Largest bend of the map over a step, relative to the difference. It bends where a joint that just
# sticks after a slide slides on at one end of the step.
BEND = 0.1
# Limit of that step, relative to the least distance from a rest, to stay on one side of it.
REST_STEP = 1e-2


class Return(NamedTuple):
    """One application of the map: end state (n,), time [s], extent (3, n), how it ended."""

    y: np.ndarray
    time: float
    extent: np.ndarray
    ended: int


class Section:
    """The Poincaré map of a loop in its free coordinates.

    A reversal counts only after a slide of ``smallest`` [rad] in the direction ``side`` (±1).
    """

    def __init__(
        self, loop: FrictionLoop, smallest: float | None = None, side: float = 1.0
    ) -> None:
        self.loop = loop
        self.side = side
        self.smallest = smallest_slide(loop) if smallest is None else smallest
        self.free = loop.free
        self._no_trace = np.empty((0, loop.states + 1))

    def state(self, s: np.ndarray) -> np.ndarray:
        """State of section coordinates."""
        y = np.zeros(self.loop.states)
        y[self.free] = s
        return y

    def follow(self, y: np.ndarray, mode: float | None = None, turns: int = 1) -> Return:
        """Follow the motion to the ``turns``-th reversal.

        ``mode`` is the piece of motion that begins at ``y``; None if ``y`` is a reversal.
        """
        y = y.copy()
        extent = extent_at(y)
        time = 0.0
        for _ in range(turns):
            first = next_mode(y, self.side, self.loop) if mode is None else mode
            mode = None
            ended, duration, _ = follow_to_reversal(
                y,
                first,
                self.loop.longest_return,
                self.loop,
                self.side,
                self.smallest,
                extent,
                self._no_trace,
            )
            time += duration
            if ended != EVENT:
                return Return(y, time, extent, ended)
        return Return(y, time, extent, EVENT)

    def map(self, s: np.ndarray, turns: int) -> np.ndarray | None:
        """P(s) applied ``turns`` times, or None if the motion does not return."""
        end = self.follow(self.state(s), turns=turns)
        return end.y[self.free] if end.ended == EVENT else None

    def jacobian(
        self, s: np.ndarray, turns: int, size: float, parts: tuple[float, ...] = (1.0,)
    ) -> np.ndarray | None:
        """dP/ds by central differences, or None if the motion does not return.

        Of the ``parts`` of the usual step the first is taken over which the map hardly bends.
        """
        end = self.follow(self.state(s), turns=turns)
        step = min(DIFFERENCE_STEP * size, REST_STEP * float(end.extent[FURTHER, CLOSEST]))
        columns = []
        for i in range(len(s)):
            # The deflection of the bristle is a torque divided by σ₀.
            scale = (
                self.loop.law.parameters.sigma0
                if self.free[i] == len(self.state(s)) + BRISTLE
                else 1.0
            )
            d = np.zeros_like(s)
            for part in parts:
                d[i] = part * step / scale
                ahead, behind = self.map(s + d, turns), self.map(s - d, turns)
                if ahead is None or behind is None:
                    return None
                change, bend = ahead - behind, ahead + behind - 2.0 * end.y[self.free]
                if np.linalg.norm(bend) < BEND * max(float(np.linalg.norm(change)), step):
                    break
            columns.append(change / (2 * d[i]))
        return np.array(columns).T


# Kinds of a final motion, and what a person sees of it beside its size.
Kind = Literal["limit_cycle", "steady", "rest", "unbounded", "irregular"]
OF_CYCLE, OF_REST = ("period_s", "stuck_fraction", "floquet_multipliers"), ("growth_rate_1_s",)
SHOWN = {"limit_cycle": OF_CYCLE, "irregular": OF_CYCLE[:2], "steady": OF_REST, "rest": OF_REST}
SIZES = ("phi_peak_to_peak_rad", "theta_peak_to_peak_rad")


def motion_text(values: Mapping[str, Any], sizes: Sequence[str]) -> str:
    """The values that have a meaning for the kind of a motion; ``sizes`` are those of its size."""
    kind = values["kind"]
    names = (*(sizes if kind in ("limit_cycle", "irregular") else ()), *SHOWN.get(kind, ()))
    return values_text({n: values[n] for n in (*names, "left_out") if n in values})


@dataclass(frozen=True, repr=False)
class LimitCycle(Result):
    """The final motion of a loop without sampling and saturation.

    ``stuck_fraction`` is the part of the period in which the arm sticks, ``floquet_multipliers``
    the factors by which disturbances grow per period. ``turns`` is the number of upper reversals of
    the arm per period, of lower ones if ``side`` is -1 because the arm never slides forward, and
    ``point`` the state (5,) at the first of them; a reversal counts after a slide of
    ``smallest_slide`` [rad]. The ``point`` of a cycle without reversals has a speed.
    ``rest_distance`` [rad, rad/s, V] is how close the cycle comes to a rest, and
    ``growth_rate_1_s`` how fast a disturbance grows at the rest or rotation, decaying if negative;
    0 at a rest that an integrator leaves and comes back to. ``left_out`` names parameters of the
    sampled loop that ``loop`` idealises.

    An irregular motion was seen over ``observed_s`` from ``point`` on, with ``turns`` upper
    reversals, after ``transient_s``; sizes and ``stuck_fraction`` are those of what was seen.

    With an infinite period the arm creeps to an unstable rest and stays there until a disturbance,
    however small, has grown with ``growth_rate_1_s``; then it moves to such a rest again.
    """

    also = ("stable", "left_out")

    kind: Kind
    phi_peak_to_peak_rad: float = 0.0
    theta_peak_to_peak_rad: float = 0.0
    period_s: float = float("nan")
    rotation_rate_rad_s: float = 0.0
    stuck_fraction: float = 0.0
    floquet_multipliers: tuple[complex, ...] = ()
    turns: int = 1
    point: tuple[float, ...] = field(default=(), repr=False)
    smallest_slide: float = field(default=0.0, repr=False)
    rest_distance: float = float("nan")
    growth_rate_1_s: float = float("nan")
    transient_s: float = float("nan")
    observed_s: float = float("nan")
    side: float = field(default=1.0, repr=False)
    loop: FrictionLoop = field(kw_only=True, repr=False, compare=False)
    left_out: tuple[str, ...] = field(default=(), repr=False)

    @property
    def stable(self) -> bool:
        """Whether disturbances decay, by all Floquet multipliers; at a rest by the growth rate.

        A motion with an infinite period is stable. Its growth rate is that of the rest which it
        leaves by a disturbance and to which it comes back: it ends the pause, not the motion.
        """
        if self.kind in ("rest", "steady"):
            return self.growth_rate_1_s <= 0.0
        return self.kind == "limit_cycle" and all(abs(m) < 1.0 for m in self.floquet_multipliers)

    def sentence(self) -> str:
        """The kind of motion, its size and its period."""
        stable = f"This motion is {'stable' if self.stable else 'unstable'}."
        size = angle(self.phi_peak_to_peak_rad)
        if self.kind == "limit_cycle" and np.isfinite(self.period_s):
            swing = swing_sentence(self.phi_peak_to_peak_rad, self.period_s, self.stuck_fraction)
            return f"{swing} {stable}"
        return {
            "limit_cycle": f"The arm moves by {size} between two rests, and stays at each until a "
            "disturbance has grown.",
            "steady": f"The arm turns at {self.rotation_rate_rad_s:.3g} rad/s. {stable}",
            "rest": f"The loop comes to rest. {stable}",
            "unbounded": "The pendulum falls.",
            "irregular": f"The arm moves irregularly, by {size}.",
        }[self.kind]

    def table(self, values: Mapping[str, Any]) -> str:
        """What has a meaning for this kind of motion."""
        return motion_text(values, SIZES)

    def trace(self) -> Trajectory:
        """One period.

        Returns:
            ``time`` (n,) [s], unevenly spaced; ``state`` (n, 5), x and the bristle [rad, rad/s];
            ``control`` and ``friction`` (n,) [V].

        Raises:
            ParameterError: The motion is no limit cycle with a finite period.
        """
        if self.kind != "limit_cycle":
            raise ParameterError(f"there is no limit cycle: the motion is {self.kind}")
        return trace(self.loop, self)

    def plot(self, axes: Any = None) -> Any:
        """Draw one period and the arm's phase plane; see :meth:`Result.plot`."""
        from furuta.figures.limit_cycle import draw_limit_cycle

        return draw_limit_cycle(self.trace(), f"{self.loop.law.name}: {self.sentence()}", axes)


def periodic_orbit(
    section: Section, guess: np.ndarray, turns: int = 1, size: float = 0.1
) -> LimitCycle | None:
    """The periodic motion near ``guess`` (section coordinates), stable or not; None if not found.

    ``size`` is the approximate size of the cycle [rad].
    """
    s = guess.copy()
    identity = np.eye(len(s))
    for _ in range(NEWTON_STEPS):
        end = section.map(s, turns)
        if end is None:
            return None
        jacobian = section.jacobian(s, turns, size)
        if jacobian is None:
            return None
        try:
            correction = np.linalg.solve(identity - jacobian, end - s)
        except np.linalg.LinAlgError:
            return None
        s = s + correction
        if np.linalg.norm(correction) < TOLERANCE * size:
            return limit_cycle_through(section, s, turns, size)
        if np.linalg.norm(correction) > 10.0 * max(size, float(np.linalg.norm(guess))):
            return None
    return None


def limit_cycle_through(
    section: Section, s: np.ndarray, turns: int, size: float
) -> LimitCycle | None:
    """The periodic motion through the fixed point ``s``; None if the arm is at rest."""
    end = section.follow(section.state(s), turns=turns)
    jacobian = section.jacobian(s, turns, size, DIFFERENCE_PARTS)
    sizes = end.extent[HIGH] - end.extent[LOW]
    phi = float(sizes[PHI])
    if jacobian is None or phi < REST:
        return None
    return LimitCycle(
        "limit_cycle",
        phi,
        float(sizes[THETA]),
        end.time,
        float(end.y[PHI] - section.state(s)[PHI]) / end.time,
        float(end.extent[FURTHER, STUCK]) / end.time,
        tuple(complex(m) for m in sorted(np.linalg.eigvals(jacobian), key=abs, reverse=True)),
        turns,
        tuple(section.state(s)),
        section.smallest,
        float(end.extent[FURTHER, CLOSEST]),
        side=section.side,
        loop=section.loop,
    )


class Trajectory(NamedTuple):
    """One period of a cycle: time (n,) [s], state (n, 5), control and friction (n,) [V]."""

    time: np.ndarray
    state: np.ndarray
    control: np.ndarray
    friction: np.ndarray


def trace(loop: FrictionLoop, cycle: LimitCycle) -> Trajectory:
    """The motion over one period, or of an irregular one what was seen, at the steps."""
    if cycle.period_s == np.inf:
        raise ParameterError("a motion with an infinite period cannot be traced over one period")
    if isinstance(loop, LinearLoop):
        loop = loop._replace(passes_rests=cycle.rest_distance < NEAR)
    y = np.array(cycle.point)
    rows = [np.append(0.0, y)]
    buffer = np.empty((MAX_TRACE, loop.states + 1))
    elapsed = 0.0
    for _ in range(cycle.turns):
        slides = float(np.sign(y[PHI_DOT]))  # without a reversal
        _, duration, n = follow_to_reversal(
            y,
            slides or next_mode(y, cycle.side, loop),
            cycle.period_s if slides and cycle.period_s > 0.0 else loop.longest_return,
            loop,
            cycle.side,
            cycle.smallest_slide,
            extent_at(y),
            buffer,
        )
        part = buffer[:n].copy()
        part[:, 0] += elapsed
        rows.extend(part)
        elapsed += duration
    table = np.array(rows)
    state = table[:, 1:]
    return Trajectory(
        table[:, 0],
        state,
        np.array([control(x, loop) for x in state]),
        np.array([friction_at(x, loop) for x in state]),
    )
