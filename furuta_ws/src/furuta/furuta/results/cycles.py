"""Final motions of loops: exact and predicted cycles, branches and maps of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from furuta.describing_functions import predicted_cycles
from furuta.describing_functions.steady_rotation import steady_rotations
from furuta.limit_cycles import joint, periodic_orbit
from furuta.limit_cycles.continuation import BranchPoint, fold_value
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.limit_cycles.periodic_orbit import Trajectory, trace
from furuta.results.motion import swing_sentence
from furuta.results.result import Found, Result
from furuta.results.text import angle, values_text
from furuta.studies.feedback_map import MapPoint
from furuta.transfer import transfer
from furuta_model.parameters import ParameterError

# What a person sees of a motion.
OF_CYCLE = ("period_s", "stuck_fraction", "floquet_multipliers")
OF_REST = ("growth_rate_1_s",)
SHOWN = {"limit_cycle": OF_CYCLE, "irregular": OF_CYCLE[:2], "steady": OF_REST, "rest": OF_REST}
SIZES = ("phi_peak_to_peak_rad", "theta_peak_to_peak_rad")


class LimitCycle(Found):
    """The final motion of a pendulum's loop without sampling and saturation.

    Fields: ``kind`` (limit_cycle, steady, rest, unbounded, irregular), ``phi_peak_to_peak_rad``,
    ``theta_peak_to_peak_rad``, ``period_s``, ``rotation_rate_rad_s``, ``stuck_fraction`` of the
    period, ``floquet_multipliers`` by which disturbances grow per period, ``stable``;
    ``growth_rate_1_s`` of a disturbance at a rest or steady motion.

    Attributes:
        loop: The loop.
        left_out: Names of parameters of the sampled loop that this one idealises.
    """

    found: periodic_orbit.LimitCycle

    def __init__(
        self, found: periodic_orbit.LimitCycle, loop: IdealLoop, left_out: Sequence[str] = ()
    ) -> None:
        super().__init__(found)
        self.loop, self.left_out = loop, list(left_out)

    def _by_name(self) -> dict[str, Any]:
        """Everything by name, except the point of the section; what has no meaning is None."""
        values = super()._by_name() | {"stable": self.found.stable, "left_out": self.left_out}
        for name in ("point", "smallest_slide", "side"):
            del values[name]
        return values

    def sentence(self) -> str:
        """The kind of motion, its size and its period."""
        cycle = self.found
        if cycle.kind == "limit_cycle" and np.isfinite(cycle.period_s):
            swing = swing_sentence(cycle.phi_peak_to_peak_rad, cycle.period_s, cycle.stuck_fraction)
            return f"{swing} {_stability(cycle.stable)}"
        return {
            "limit_cycle": f"The arm moves by {angle(cycle.phi_peak_to_peak_rad)} between two "
            "rests, and stays at each until a disturbance has grown.",
            "steady": f"The arm turns at {cycle.rotation_rate_rad_s:.3g} rad/s. "
            f"{_stability(cycle.stable)}",
            "rest": f"The loop comes to rest. {_stability(cycle.stable)}",
            "unbounded": "The pendulum falls.",
            "irregular": f"The arm moves irregularly, by {angle(cycle.phi_peak_to_peak_rad)}.",
        }[cycle.kind]

    def table(self, values: Mapping[str, Any]) -> str:
        """What has a meaning for this kind of motion."""
        sizes = SIZES if self.found.kind in ("limit_cycle", "irregular") else ()
        return values_text(_chosen(values, (*sizes, *SHOWN.get(self.found.kind, ()), "left_out")))

    def trace(self) -> Trajectory:
        """One period.

        Returns:
            ``time`` (n,) [s], unevenly spaced; ``state`` (n, 5), x and the bristle [rad, rad/s];
            ``control`` and ``friction`` (n,) [V].

        Raises:
            ParameterError: The motion is no limit cycle with a finite period.
        """
        if self.found.kind != "limit_cycle":
            raise ParameterError(f"there is no limit cycle: the motion is {self.found.kind}")
        return trace(self.loop, self.found)

    def plot(self, axes: Any = None) -> Any:
        """Draw one period and the arm's phase plane; see :meth:`Result.plot`."""
        from furuta.figures.limit_cycle import draw_limit_cycle

        return draw_limit_cycle(self.trace(), f"{self.loop.law.name}: {self.sentence()}", axes)


def _chosen(values: Mapping[str, Any], names: Sequence[str]) -> dict[str, Any]:
    return {name: values[name] for name in names}


def _stability(stable: bool) -> str:
    return "This motion is stable." if stable else "This motion is unstable."


class JointCycle(Found):
    """The final motion of any linear loop with a friction joint, in the loop's own units.

    Fields: ``kind`` (limit_cycle, steady, rest, unbounded, irregular), ``peak_to_peak`` of the
    position without its mean motion, ``period_s``, ``stuck_fraction``, ``floquet_multipliers``,
    ``growth_rate_1_s``, ``start`` (the state at the upper reversal), ``stable``.

    Attributes:
        loop: The loop.
    """

    found: joint.JointCycle

    def __init__(self, found: joint.JointCycle, loop: joint.Joint) -> None:
        super().__init__(found)
        self.loop = loop

    def _by_name(self) -> dict[str, Any]:
        """Everything by name; what has no meaning is None."""
        values = super()._by_name() | {"stable": self.found.stable}
        del values["scaled"], values["start"]
        return values

    def sentence(self) -> str:
        """The kind of motion, its size and its period."""
        return joint_sentence(self.found, f"{self.found.peak_to_peak:.3g}")

    def table(self, values: Mapping[str, Any]) -> str:
        """What has a meaning for this kind of motion."""
        sizes = ("peak_to_peak",) if self.found.kind in ("limit_cycle", "irregular") else ()
        return values_text(_chosen(values, (*sizes, *SHOWN.get(self.found.kind, ()))))

    def trace(self) -> Trajectory:
        """One period: ``time`` (n,) [s], ``state``, position and x (n, 1 + states), forces (n,).

        Raises:
            ParameterError: The motion is no limit cycle with a finite period.
        """
        return joint.trace_joint(self.loop, self.found)

    def plot(self, axes: Any = None) -> Any:
        """Draw one period and the phase plane; see :meth:`Result.plot`."""
        from furuta.figures.limit_cycle import draw_joint

        return draw_joint(self.trace(), self.sentence(), axes)


def joint_sentence(cycle: joint.JointCycle, size: str, name: str = "The joint") -> str:
    """The kind of motion of a joint, whose peak to peak is ``size`` in words."""
    if cycle.kind == "limit_cycle" and np.isfinite(cycle.period_s):
        stuck = 100 * cycle.stuck_fraction
        sticks = f"; it sticks {stuck:.0f} % of the time" * (stuck > 0.0)
        return f"{name} hunts by {size} every {cycle.period_s:.3g} s{sticks}."
    return {
        "limit_cycle": f"{name} moves by {size} between two rests, and stays at each until a "
        "disturbance has grown.",
        "steady": f"{name} moves steadily.",
        "rest": f"{name} comes to rest.",
        "unbounded": "The motion grows without bound.",
        "irregular": f"{name} moves irregularly, by {size}.",
    }[cycle.kind]


class Prediction(Found):
    """Limit cycles that the describing function predicts.

    Fields: ``cycles`` in order of amplitude, each with ``omega_rad_s``,
    ``velocity_amplitude_rad_s``, ``phi_peak_to_peak_rad``, ``period_s``, ``stable``, ``bias_v``;
    ``omega_range_rad_s`` and ``phi_amplitude_range_rad`` that were searched; ``complete``. Of a
    linear loop with a friction joint they are in its own units.

    Attributes:
        loop: The loop; of a friction joint it is a :class:`furuta.limit_cycles.joint.Joint`.
    """

    found: predicted_cycles.Prediction
    details = frozenset({"law", "feedback", "searched", "complete"})

    def __init__(
        self,
        found: predicted_cycles.Prediction,
        loop: IdealLoop | joint.Joint,
        left_out: Sequence[str] = (),
    ) -> None:
        super().__init__(found)
        self.loop, self.left_out = loop, list(left_out)

    def _by_name(self) -> dict[str, Any]:
        """The cycles and what was searched; of a pendulum's loop also its steady rotations."""
        found, loop = self.found, self.loop
        values: dict[str, Any] = {"cycles": found.cycles}
        if isinstance(loop, IdealLoop):
            values = {
                "law": loop.law.name,
                "feedback": list(loop.gains),
                "stable_without_friction": transfer(loop.body, loop.gains).stable,
                **values,
                "rotations": steady_rotations(loop.body, loop.gains, loop.law),
            }
        searched = {
            "omega_rad_s": found.omega_range_rad_s,
            "phi_amplitude_rad": found.phi_amplitude_range_rad,
        }
        values |= {"searched": searched, "complete": found.complete}
        return values | {"left_out": self.left_out}

    def sentence(self) -> str:
        """The largest stable cycle, and how many there are."""
        cycles = self.found.cycles
        stable = [cycle for cycle in cycles if cycle.stable]
        if not stable:
            return f"The describing function predicts no stable limit cycle ({len(cycles)} in all)."
        largest = stable[-1]
        size = f"{largest.phi_peak_to_peak_rad:.3g}"
        if isinstance(self.loop, IdealLoop):
            size = angle(largest.phi_peak_to_peak_rad)
        return (
            f"The describing function predicts a limit cycle of {size} every "
            f"{largest.period_s:.3g} s{'' if len(cycles) == 1 else f', one of {len(cycles)}'}."
        )

    def plot(self, axes: Any = None) -> Any:
        """Draw G and −1/N, and N over the amplitude; see :meth:`Result.plot`."""
        from furuta.figures.nyquist import draw_describing_function

        if not isinstance(self.loop, IdealLoop):
            raise ParameterError("the prediction of a friction joint has no figure")
        return draw_describing_function(self.loop, self.found, axes)


class Branch(Result):
    """Limit cycles along a branch over a parameter, in order along the branch.

    Attributes:
        name: The parameter.
        points: Cycles, each with its ``value`` of the parameter, ``cycle`` and ``event``: fold (the
            parameter reverses: a stable and an unstable cycle meet and disappear), vanishes,
            homoclinic (the period grows without bound), end (of the range), lost.
        cycle: The motion at the loop's own value of the parameter.
    """

    def __init__(
        self, name: str, points: Sequence[BranchPoint], cycle: LimitCycle | JointCycle
    ) -> None:
        self.name, self.points, self.cycle = name, list(points), cycle

    @property
    def values(self) -> np.ndarray:
        """Values of the parameter (n,)."""
        return np.array([point.value for point in self.points])

    def _by_name(self) -> dict[str, Any]:
        """The motion of the loop itself, then the ``branch`` and its ``events``."""
        size = "peak_to_peak" if isinstance(self.cycle, JointCycle) else "phi_peak_to_peak_rad"
        return {
            **self.cycle._by_name(),
            "branch": [
                {
                    self.name: point.value,
                    size: getattr(point.cycle, size),
                    "period_s": point.cycle.period_s,
                    "stable": point.cycle.stable,
                }
                for point in self.points
            ],
            "events": [
                {
                    "event": point.event,
                    self.name: (
                        fold_value(self.points, i, size) if point.event == "fold" else point.value
                    ),
                }
                for i, point in enumerate(self.points)
                if point.event
            ],
        }

    def report(self) -> str:
        """Where the branch begins, folds and ends, then its cycles."""
        values = self.to_dict()
        return "\n\n".join(
            (self.sentence(), self.table({name: values[name] for name in ("events", "branch")}))
        )

    def sentence(self) -> str:
        """The range of the branch, and whether it folds."""
        folds = sum(point.event == "fold" for point in self.points)
        turns = {0: "", 1: ", with one fold"}.get(folds, f", with {folds} folds")
        low, high = np.min(self.values), np.max(self.values)
        return f"The limit cycle exists for {self.name} from {low:.4g} to {high:.4g}{turns}."

    def plot(self, axes: Any = None) -> Any:
        """Draw size and period over the parameter; see :meth:`Result.plot`."""
        from furuta.figures.figure import axis_label
        from furuta.figures.limit_cycle import draw_branch

        label = self.name if isinstance(self.cycle, JointCycle) else axis_label(self.name)
        return draw_branch(label, self.points, axes)


class CycleMap(Result):
    """Final motions over a grid of two parameters.

    Attributes:
        names: The two parameters.
        values: Their values (m,) and (n,).
        points: Motions, m times n; the second parameter changes fastest.
    """

    def __init__(
        self,
        names: tuple[str, str],
        values: tuple[np.ndarray, np.ndarray],
        points: Sequence[MapPoint],
        left_out: Sequence[str] = (),
    ) -> None:
        self.names, self.values, self.points = names, values, list(points)
        self.left_out = list(left_out)

    def _by_name(self) -> dict[str, Any]:
        """The ``rows`` of the map, with the kind and size of each motion."""
        rows = [point.row(*self.names) for point in self.points]
        return {"rows": rows, "left_out": self.left_out}

    def sentence(self) -> str:
        """How many motions there are of each kind."""
        kinds = [point.kind for point in self.points]
        counts = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds))
        return f"{len(kinds)} motions over {' and '.join(self.names)}: {counts}."

    def plot(self, axes: Any = None) -> Any:
        """Draw the size over both parameters, predicted and exact; see :meth:`Result.plot`."""
        from furuta.figures.feedback_map import draw_map

        return draw_map(*self.names, *self.values, self.points, axes)
