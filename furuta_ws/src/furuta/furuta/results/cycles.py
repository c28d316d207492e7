"""Final motions of loops: exact and predicted cycles, branches and maps of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from furuta.describing_functions import predicted_cycles
from furuta.describing_functions.steady_rotation import steady_rotations
from furuta.limit_cycles.continuation import BranchPoint, fold_value
from furuta.limit_cycles.joint import Joint, JointCycle
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.limit_cycles.periodic_orbit import LimitCycle
from furuta.results.result import Result
from furuta.results.text import angle
from furuta.studies.feedback_map import MapPoint
from furuta.transfer import transfer
from furuta_model.parameters import ParameterError


@dataclass(frozen=True, repr=False)
class Prediction(Result, predicted_cycles.Prediction):
    """Limit cycles that the describing function predicts.

    Fields: ``cycles`` in order of amplitude, each with ``omega_rad_s``,
    ``velocity_amplitude_rad_s``, ``phi_peak_to_peak_rad``, ``period_s``, ``stable``, ``bias_v``;
    ``omega_range_rad_s`` and ``phi_amplitude_range_rad`` that were searched; ``complete``. Of a
    linear loop with a friction joint they are in its own units.

    Attributes:
        loop: The loop; of a friction joint it is a :class:`furuta.limit_cycles.joint.Joint`.
        left_out: Names of parameters of the sampled loop that this one idealises.
    """

    loop: IdealLoop | Joint = field(kw_only=True, compare=False)
    left_out: tuple[str, ...] = ()

    details = frozenset({"law", "feedback", "searched", "complete"})

    def _by_name(self) -> dict[str, Any]:
        """The cycles and what was searched; of a pendulum's loop also its steady rotations."""
        loop = self.loop
        values: dict[str, Any] = {"cycles": self.cycles}
        if isinstance(loop, IdealLoop):
            values = {
                "law": loop.law.name,
                "feedback": list(loop.gains),
                "stable_without_friction": transfer(loop.body, loop.gains).stable,
                **values,
                "rotations": steady_rotations(loop.body, loop.gains, loop.law),
            }
        searched = {
            "omega_rad_s": self.omega_range_rad_s,
            "phi_amplitude_rad": self.phi_amplitude_range_rad,
        }
        values |= {"searched": searched, "complete": self.complete}
        return values | {"left_out": self.left_out}

    def sentence(self) -> str:
        """The largest stable cycle, and how many there are."""
        cycles = self.cycles
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
        return draw_describing_function(self.loop, self, axes)


@dataclass(frozen=True, repr=False, eq=False)
class Branch(Result):
    """Limit cycles along a branch over a parameter, in order along the branch.

    Attributes:
        name: The parameter.
        points: Cycles, each with its ``value`` of the parameter, ``cycle`` and ``event``: fold (the
            parameter reverses: a stable and an unstable cycle meet and disappear), vanishes,
            homoclinic (the period grows without bound), end (of the range), lost.
        cycle: The motion at the loop's own value of the parameter.
    """

    name: str
    points: list[BranchPoint]
    cycle: LimitCycle | JointCycle

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


@dataclass(frozen=True, repr=False, eq=False)
class CycleMap(Result):
    """Final motions over a grid of two parameters.

    Attributes:
        names: The two parameters.
        values: Their values (m,) and (n,).
        points: Motions, m times n; the second parameter changes fastest.
        left_out: Names of parameters of the sampled loop that this one idealises.
    """

    names: tuple[str, str]
    values: tuple[np.ndarray, np.ndarray]
    points: list[MapPoint]
    left_out: tuple[str, ...] = ()

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
