"""Servo axes: their final motions with what helps against hunting, and simulated runs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from furuta.axis.axis import Axis, Controller
from furuta.axis.compensations import SHORTEST, AxisComparison, Residual
from furuta.axis.draws import Consequences, left_out
from furuta.axis.identified_axis import IdentifiedAxis
from furuta.axis.quiet_gains import COUNTS, HUNTING, QuietGains, gain_rows, stable_gains
from furuta.axis.simulation import AxisRecord, simulate_axis
from furuta.identification.axis.fit import AxisFit
from furuta.limit_cycles.joint import JointCycle
from furuta.results.result import Result
from furuta.results.table import Table
from furuta.results.text import angle, values_text
from furuta_model.parameters import ParameterError

if TYPE_CHECKING:
    from furuta.axis.proof import Proof  # it needs python-flint

# Where an axis may start beside its usual start.
NEAR = {"rest": "the reference", "steady motion": "steady motion"}
OF_OTHERS = ("start", "kind", "peak_to_peak_rad", "period_s", "stable")
# Periods of a cycle for which runs are drawn, after as many.
PERIODS = 2


class Sampling(NamedTuple):
    """Counts per turn, time between samples [s], and delay of the torque [s] of a simulation."""

    counts: int
    sample_time: float
    delay: float


@dataclass(frozen=True, eq=False)
class Study:
    """What was computed of an ``axis`` under a ``controller``, behind a ``speed`` [rad/s].

    ``motions`` by start, of which the first follows from rest. Of an identified axis, the ``fit``
    and the ``consequences``. A ``comparison`` of compensations unless the motion is unbounded;
    ``quiet`` gains that end the hunting; a ``proof`` of the limit cycle.
    """

    axis: Axis
    controller: Controller
    speed: float
    sampling: Sampling
    motions: dict[str, JointCycle]
    fit: IdentifiedAxis | None
    consequences: Consequences | None = None
    comparison: AxisComparison | None = None
    quiet: QuietGains | None = None
    proof: Proof | None = None


@dataclass(frozen=True, repr=False, eq=False)
class AxisStudy(Result, Study):
    """The final motions of an axis, and what helps against hunting; fields: of :class:`Study`."""

    @property
    def cycle(self) -> JointCycle:
        """The final motion from rest."""
        return next(iter(self.motions.values()))

    @property
    def recommended(self) -> str | None:
        """The simplest of the best compensations; None if no compensation has settled."""
        best = self._best
        return best.compensation if best is not None and best.settled else None

    @property
    def still_hunts(self) -> bool:
        """Whether a hunting axis moves by more than two counts with that compensation."""
        return self.cycle.kind in HUNTING and self._moves

    @property
    def _moves(self) -> bool:
        counts, best = self.sampling.counts, self._best
        least = COUNTS * 2.0 * pi / counts if counts else 0.0
        return best is not None and best.peak_to_peak_rad > least

    @property
    def _best(self) -> Residual | None:
        return self.comparison.recommended if self.comparison is not None else None

    @property
    def units(self) -> tuple[str, str]:
        """The units of position and torque: rad and N m, or m and N."""
        return (
            ("rad", "N m") if self.fit is None else (self.fit.position_unit, self.fit.torque_unit)
        )

    def _by_name(self) -> dict[str, Any]:
        """The motion from rest, then the others, the compensations, and what a recording allows.

        Names end in rad and nm whatever the units are; ``units`` has those of position and torque.
        """
        rows = []
        for start, motion in self.motions.items():
            row = {"start": start, **motion._by_name()}
            rows.append(row | {"peak_to_peak_rad": row.pop("peak_to_peak")})
        values: dict[str, Any] = {
            **({} if self.fit is None else {"identified": self.fit._by_name()}),
            **rows[0],
            "other_motions": [{name: row[name] for name in OF_OTHERS} for row in rows[1:]],
            "compensations": [],
            "recommended": self.recommended,
            "units": dict(zip(("position", "torque"), self.units, strict=True)),
        }
        if self.fit is not None and self.consequences is not None:
            low, high = self.consequences[2:]
            values |= {
                "hunts_in": self.consequences.hunts_in,
                "hunting_rad": [low, high],
                "uncertainty": self.consequences.sentence(self.fit),
                "left_out": left_out(self.fit),
            }
        if self.comparison is not None:
            values |= {
                "compensations": self.comparison.residuals,
                "still_hunts": self.still_hunts,
                "ends_hunting": None if self.quiet is None else self.quiet.sentence(),
                "gains": self._gains(),
                **{f"{name}_s": each for name, each in self.sampling._asdict().items()},
            }
            values["counts"] = values.pop("counts_s")
        return values | ({} if self.proof is None else {"proof": self.proof})

    def _gains(self) -> list[dict[str, Any]]:
        quiet = None if self.quiet is None else self.quiet.controller
        recorded = ("rad", 1.0) if self.fit is None else self.fit.recorded_unit
        return gain_rows(self.controller, quiet, self.units, recorded)

    def size(self, position: float) -> str:
        """A position in words."""
        unit, _ = self.units
        return angle(position) if unit == "rad" else f"{position:.3g} {unit}"

    def sentence(self) -> str:
        """How the axis ends, what a recording leaves open, and what helps."""
        return " ".join(self._sentences())

    def _sentences(self) -> Iterable[str]:
        cycle = self.cycle
        yield cycle.sentence(self.size(cycle.peak_to_peak), "The axis")
        if cycle.kind == "unbounded":
            stable = stable_gains(self.axis, self.controller)
            gains = ", or ".join(f"{name} {value:g}" for name, value in stable.items())
            yield "The gains are unstable even without friction."
            yield f"Alone would be stable: {gains}." if gains else "No change of one gain helps."
        for start, motion in list(self.motions.items())[1:]:
            yield f"Started near {NEAR[start]}, it ends otherwise: {motion.kind}."
        if self.fit is not None and self.consequences is not None:
            yield f"It {self.consequences.sentence(self.fit)}."
        if self.comparison is not None:
            yield self._of_best(self.comparison.recommended)
        if self.quiet is not None:
            yield f"What ends the hunting without compensation: {self.quiet.sentence()}."

    def _of_best(self, best: Residual) -> str:
        if self.recommended is None:
            return "No compensation has settled."
        if best.compensation == "none":
            return (
                f"No compensation is best here: the error is at most {self.size(best.error_rad)}."
            )
        assert self.comparison is not None
        without = next(row for row in self.comparison.residuals if row.compensation == "none")
        hunts = ""
        if self._moves:
            moved = self.size(best.peak_to_peak_rad)
            hunts = f"; it {'still hunts' if self.still_hunts else 'then moves'} by {moved}"
        return (
            f"The compensation {best.compensation} is best here: the error is at most "
            f"{self.size(best.error_rad)} instead of {self.size(without.error_rad)}{hunts}."
        )

    def table(self, values: Mapping[str, Any]) -> str:
        """What was identified, then the compensations, gains and other motions as tables."""
        position, torque = self.units
        counts = f"{self.sampling.counts} counts per turn" if self.sampling.counts else "no encoder"
        rate = f"every {1e3 * self.sampling.sample_time:.4g} ms, {counts}"

        def in_units(rows: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
            ends = {"_rad": f" [{position}]", "_nm": f" [{torque}]"}
            return [{_titled(name, ends): each for name, each in row.items()} for row in rows]

        tables = {
            "compensations": in_units(values["compensations"]),
            "simulated": rate if values["compensations"] else "",
            "gains": values.get("gains", []),
            "other_motions": in_units(values["other_motions"]),
            "left_out": values.get("left_out", []),
            "proof": values.get("proof", {}),
        }
        of_fit = f"{self.fit.report()}\n\n" if isinstance(self.fit, AxisFit) else ""
        return of_fit + values_text(tables)

    def write(self, path: str | Path) -> None:
        """Write a joint file of an identified axis, with its controller and the best compensation.

        Raises:
            ParameterError: The axis was not identified, or has no dry friction.
        """
        if self.fit is None:
            raise ParameterError(
                "a joint file needs what is identified: study what identify returns"
            )
        self.fit.write(path, self.controller, self.recommended)

    def runs(self) -> dict[str, AxisRecord]:
        """Simulations without and with the best compensation, by name."""
        cycle = self.cycle
        hunts = cycle.kind == "limit_cycle" and np.isfinite(cycle.period_s)
        names = dict.fromkeys(("none", self.recommended)) if self.recommended else ()
        return {
            name: simulate_axis(
                self.axis,
                self.controller,
                seconds=max(2.0 * PERIODS * cycle.period_s, SHORTEST) if hunts else SHORTEST,
                reference=self.speed,
                compensation=name,
                by_topic=self.fit is not None,
                **self.sampling._asdict(),
            )
            for name in names
        }

    def plot(self, axes: Any = None) -> Any:
        """Draw the exact motion and simulated errors, and the friction of a fit.

        See :meth:`Result.plot`.
        """
        from furuta.figures.servo_axis import draw_axis
        from furuta.identification.axis.friction_curve import axis_followed, axis_friction

        motion, fit, units = None, self.fit, self.units
        if self.cycle.kind == "unbounded":
            raise ParameterError(f"an unbounded motion has no figure. {self.sentence()}")
        if self.cycle.kind == "limit_cycle" and np.isfinite(self.cycle.period_s):
            motion = self.cycle.trace()
        title = self.cycle.sentence(self.size(self.cycle.peak_to_peak), "The axis")
        shown = (axis_friction(fit), axis_followed(fit)) if isinstance(fit, AxisFit) else None
        return draw_axis(motion, self.runs(), units, title, shown, axes)


def _titled(name: str, ends: Mapping[str, str]) -> str:
    for end, unit in ends.items():
        if name.endswith(end):
            return f"{name.removesuffix(end).replace('_', ' ')}{unit}"
    return name


@dataclass(frozen=True, repr=False, eq=False)
class AxisRun(Result, AxisRecord):
    """A simulated axis, one row per sample.

    Fields: ``time`` (n,) [s], ``reference``, true ``position``, ``measured`` position and ``error``
    (n,) [rad], ``torque`` (n,) [N m], which acts until the next sample.
    """

    def _by_name(self) -> dict[str, Any]:
        """Largest error and its peak to peak in the second half, and the chatter of the torque."""
        settled = slice(len(self.time) // 2, None)
        error, steps = self.error[settled], np.diff(self.torque[settled])
        return {
            "error_rad": float(np.max(np.abs(error))),
            "peak_to_peak_rad": float(np.ptp(error)),
            "chatter_nm": float(np.sqrt(np.mean(steps**2))),
        }

    def sentence(self) -> str:
        """How large the error is."""
        values = self.to_dict()
        return (
            f"In the second half the error is at most {angle(values['error_rad'])}, "
            f"{angle(values['peak_to_peak_rad'])} peak to peak."
        )

    def series(self) -> Table:
        """Time [s], measured position and torque as columns, for :func:`furuta.read_axis`."""
        return Table({"time": self.time, "position": self.measured, "torque": self.torque})

    def write(self, path: str | Path) -> None:
        """Write :meth:`series`; see :meth:`furuta.results.table.Table.write`."""
        self.series().write(path)

    def plot(self, axes: Any = None) -> Any:
        """Draw error and torque over time; see :meth:`Result.plot`."""
        from furuta.figures.servo_axis import draw_run

        return draw_run(self, axes)
