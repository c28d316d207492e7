"""Servo axes: their final motions with what helps against hunting, and simulated runs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import inf, pi
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from furuta.axis.axis import HUNTING, NO_RULE, Axis, Controller, IntegralRule, without_integral
from furuta.axis.compensations import COUNTS, SHORTEST, AxisComparison, Residual
from furuta.axis.cures import HOLDING, Cure, simplest
from furuta.axis.draws import Consequences, left_out
from furuta.axis.gains import gain_rows, per_unit, stable_gains
from furuta.axis.identified_axis import IdentifiedAxis
from furuta.axis.joint_file import OF_LOAD
from furuta.axis.quiet_gains import QuietGains
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
    ``cures`` of the hunting within a ``tolerance`` [rad]; ``quiet`` gains behind a reference that
    moves, or of a law with a bristle; a ``proof`` of the limit cycle.
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
    cures: tuple[Cure, ...] | None = None
    tolerance: float = inf
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
        """The simplest of the best compensations; none if no compensation is worth it."""
        return None if self._best is None else self._best.compensation

    @property
    def still_hunts(self) -> bool:
        """Whether a hunting axis moves by more than two counts with that compensation."""
        least = COUNTS * self._count
        best = self._best
        return self.cycle.kind in HUNTING and best is not None and best.peak_to_peak_rad > least

    @property
    def _best(self) -> Residual | None:
        return self.comparison.recommended if self.comparison is not None else None

    @property
    def _count(self) -> float:
        """A count of the encoder [rad], 0 for a perfect one."""
        return 2.0 * pi / self.sampling.counts if self.sampling.counts else 0.0

    @property
    def advice(self) -> Cure | Residual | None:
        """The simplest cure of those that leave the smallest error, or else a compensation.

        A cure rests from all starts. A compensation is simulated from some, and may end in another
        motion from others.
        """
        best = self._best
        if self.cures:
            return simplest(self.cures, self._count, self.tolerance)
        return best if best and best.worth and best.error_rad <= self.tolerance else None

    def _changed(self, advice: Cure | Residual | None) -> tuple[str, Controller, IntegralRule, str]:
        """The name of a change, its gains, the rule of its integral, and its compensation."""
        match advice:
            case Cure(name, gains, rule):
                return name, gains, rule, "none"
            case Residual(compensation=name, integral=False):
                gains = without_integral(self.controller)
                return f"compensation {name}, no integral action", gains, HOLDING, name
            case Residual(compensation=name):
                return f"compensation {name}", self.controller, NO_RULE, name
        return "as given", self.controller, NO_RULE, "none"

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
                "advice": self._changed(self.advice)[0],
                "cures": [_cure_row(cure) for cure in self.cures or ()],
                "gains": self._gains(),
                **{f"{name}_s": each for name, each in self.sampling._asdict().items()},
            }
            values["counts"] = values.pop("counts_s")
        return values | ({} if self.proof is None else {"proof": self.proof})

    def _gains(self) -> list[dict[str, Any]]:
        quiet = None if self.quiet is None else self.quiet.controller
        return gain_rows(self.controller, quiet, self.units, self._recorded)

    @property
    def _recorded(self) -> tuple[str, float]:
        """The unit of the recorded position, and its size in that of :attr:`units`."""
        return (self.units[0], 1.0) if self.fit is None else self.fit.recorded_unit

    def size(self, position: float) -> str:
        """A position in words, in the unit of the recording."""
        unit, size = self._recorded
        return angle(position) if unit == "rad" else f"{position / size:.3g} {unit}"

    def sentence(self) -> str:
        """What to do, how the axis ends without it, and what a recording leaves open."""
        return " ".join(self._sentences())

    def _sentences(self) -> Iterable[str]:
        cycle = self.cycle
        if self.advice is not None:
            yield self._what_to_do(self.advice)
        text = cycle.sentence(self.size(cycle.peak_to_peak), "The axis")
        yield text if self.advice is None else f"As it is, t{text[1:]}"
        if cycle.kind == "unbounded":
            _, size = self._recorded
            stable = stable_gains(self.axis, self.controller)
            values = per_unit(self.controller._replace(**stable), size)._asdict()
            gains = ", or ".join(f"{name} {float(f'{values[name]:.2g}'):g}" for name in stable)
            yield "The gains are unstable even without friction."
            yield (
                f"One of these changes makes it stable: {gains}."
                if gains
                else "No change of one gain helps."
            )
        for start, motion in list(self.motions.items())[1:]:
            ends = motion.sentence(self.size(motion.peak_to_peak), "it")
            yield f"Started near {NEAR[start]}, {ends}"
        if self.fit is not None and self.consequences is not None:
            yield f"{self.consequences.sentence(self.fit)}."
        best = self._best
        if best is not None and not best.worth:
            yield "No compensation is worth it here."
        elif best is not None and best != self.advice:
            yield (
                f"In simulations, the compensation {best.compensation}{_instead(best)} leaves at "
                f"most {self.size(best.error_rad)}{self._still(best)}."
            )
        if self.quiet is not None:
            yield f"Without compensation, {self.quiet.sentence()}."
        if self.cures == ():
            within = f" within {self.size(self.tolerance)}" if self.tolerance < inf else ""
            yield (
                f"Without compensation, nothing that was tried rests{within}, with friction 0.8 to "
                "1.25 times as large and one sample more of delay."
            )

    def _what_to_do(self, advice: Cure | Residual) -> str:
        if isinstance(advice, Cure):
            within = f"within {self.size(advice.error)} after at most {advice.seconds:.3g} s"
            if advice.rule == HOLDING:
                return f"Switch off the integral action: friction then holds the axis {within}."
            rule = advice.rule
            parts = [f"pause the integral while the error is below {self.size(rule.dead_band)}"]
            if rule.resets:
                parts.append(f"set it to {self._held} where the error changes its sign")
            if rule.limit:
                parts.append(
                    f"keep it within ±{rule.limit:.3g} {self.units[1]} while the axis moves"
                )
            told = f"{', '.join(parts[:-1])} and {parts[-1]}" if parts[1:] else parts[0]
            return (
                f"{told[0].upper()}{told[1:]}: it then pushes the axis no longer past the "
                f"reference, and the axis rests {within}."
            )
        assert self.comparison is not None
        without = self.comparison.residuals[0]
        return (
            f"Use the compensation {advice.compensation}{_instead(advice)}: the error is then at "
            f"most {self.size(advice.error_rad)} instead of {self.size(without.error_rad)}"
            f"{self._still(advice)}."
        )

    def _still(self, best: Residual) -> str:
        """By how much the axis hunts with a compensation, if it does."""
        return f"; it still hunts by {self.size(best.peak_to_peak_rad)}" if self.still_hunts else ""

    @property
    def _held(self) -> str:
        """What the integral is set to: 0, or the load of a recording if that is not noise."""
        found = None if self.fit is None else self.fit
        loaded = found is not None and any(
            abs(found.values.get(name, 0.0)) > 2.0 * found.standard_errors.get(name, inf)
            for name in OF_LOAD
        )
        return "the torque that holds the load" if loaded else "0"

    def table(self, values: Mapping[str, Any]) -> str:
        """What was identified, then the compensations, gains and other motions as tables."""
        (position, size), torque = self._recorded, self.units[1]
        counts = f"{self.sampling.counts} counts per turn" if self.sampling.counts else "no encoder"
        every, late = (1e3 * each for each in self.sampling[1:])
        rate = f"every {every:.4g} ms, {counts}, torque {late:.3g} to {late + every:.3g} ms late"

        def in_units(rows: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
            ends = {"_rad": f" [{position}]", "_nm": f" [{torque}]"}
            return [
                {
                    _titled(name, ends): each / size if each and name.endswith("_rad") else each
                    for name, each in row.items()
                    if name != "settled"
                }
                for row in rows
            ]

        gains = values.get("gains", [])
        tables = {
            "ends_hunting": in_units(values.get("cures", [])),
            "compensations": in_units(values["compensations"]),
            "simulated": rate if values["compensations"] else "",
            "gains": gains if any(len(row) > 3 for row in gains) else [],
            "other_motions": in_units(values["other_motions"]),
            "left_out": values.get("left_out", []),
            "proof": values.get("proof", {}),
        }
        of_fit = f"{self.fit.report()}\n\n" if isinstance(self.fit, AxisFit) else ""
        return of_fit + values_text(tables)

    def write(self, path: str | Path) -> None:
        """Write a joint file of an identified axis, with its controller and the best compensation.

        If no compensation is worth it, the file has the rule of the integral that is advised.

        Raises:
            ParameterError: The axis was not identified, or has no dry friction.
        """
        if self.fit is None:
            raise ParameterError(
                "a joint file needs what is identified: study what identify returns"
            )
        worth = self._best is not None and self._best.worth
        _, controller, rule, compensation = self._changed(self._best if worth else self.advice)
        self.fit.write(path, controller, compensation, rule)

    def runs(self) -> dict[str, AxisRecord]:
        """Simulations as given and as advised, by name."""
        cycle = self.cycle
        hunts = cycle.kind == "limit_cycle" and np.isfinite(cycle.period_s)
        shown = dict.fromkeys((self._changed(None), self._changed(self.advice)))
        return {
            name: simulate_axis(
                self.axis,
                controller,
                seconds=max(2.0 * PERIODS * cycle.period_s, SHORTEST) if hunts else SHORTEST,
                reference=self.speed,
                compensation=compensation,
                rule=rule,
                by_topic=self.fit is not None,
                **self.sampling._asdict(),
            )
            for name, controller, rule, compensation in shown
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


def _instead(best: Residual) -> str:
    return "" if best.integral else " instead of integral action"


def _cure_row(cure: Cure) -> dict[str, Any]:
    """A cure as a row; a number that it does not have is None."""
    rule = cure.rule
    return {
        "change": cure.name,
        "dead_band_rad": rule.dead_band or None,
        "limit_nm": rule.limit or None,
        "error_rad": cure.error,
        "rests_after_s": cure.seconds,
    }


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
