"""Studies of many runs: sweeps, comparisons, swing-ups, tunings, and the demo."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from furuta.results.result import Result
from furuta.results.table import Table
from furuta.results.text import angle, table_text, values_text
from furuta.studies import trials
from furuta.studies.comparison import comparison
from furuta.studies.comparison.candidates import Candidate
from furuta.studies.comparison.scores import rank, recommended
from furuta.studies.phases import Phase, evaluate
from furuta.studies.study_tables import SIZE, Passed, columns
from furuta.studies.swing_up import DEADLINE, Knocks, StartResults, SwingUpRun
from furuta_model.parameters import ParameterError
from furuta_recordings.bags.recorded_loop import RecordedRun

# Headings of what a person sees of a run, and of a candidate; ALL are those with every column.
MOTION = {
    SIZE: "arm [rad]",
    "theta_peak_to_peak_rad": "pendulum [rad]",
    "period_s": "period [s]",
}
CANDIDATE = {
    "candidate": "candidate",
    "residual_median_rad": "median [rad]",
    "residual_95_rad": "95 % [rad]",
    "residual_worst_rad": "worst [rad]",
    "worse_than_none": "worse than none",
    "falls": "fell",
}
ALL = CANDIDATE | {
    "within_count": "within a count",
    "worst_ratio": "worst ratio to none",
    "sensors_alone_rad": "sensors alone [rad]",
    "command_rms_v": "rms u [V]",
    "command_step_v": "rms Δu [V]",
    "command_high_frequency_v": "u > 50 Hz [V]",
    "delay_margin_s": "delay margin [s]",
    "pushes_survived": "pushes survived",
}
# What is said of the runs of a sweep.
COUNTED = ("runs", "fell", "impossible", "smallest", "largest")
BEST = {"best_bandwidth": "best bandwidth [1/s]", "residual_at_best_rad": "with it [rad]"}


class Runs(Table):
    """Runs over every combination of some values, a row each.

    Columns: the parameters; what :func:`furuta.measure` returns; and ``error``, which says why
    the parameters are impossible. Such a run has NaN.

    Attributes:
        found: Their number, how many ``fell`` or are ``impossible``, the rows with the
            ``smallest`` and the ``largest`` swing, and the first rows.
        file: Where the rows are, if they were written.
    """

    def __init__(
        self, found: Passed, rows: Iterable[Mapping[str, Any]], file: Path | None = None
    ) -> None:
        super().__init__(columns(rows))
        self.found, self.file = found, file

    def _by_name(self) -> dict[str, Any]:
        """How many runs there are, the extreme ones, and the rows or their file."""
        found = self.found
        return {
            **{name: getattr(found, name) for name in COUNTED},
            **({"file": str(self.file)} if self.file else {"rows": self.dictionaries()}),
        }

    def sentence(self) -> str:
        """How many runs there are, and where the arm swings least and most."""
        found = self.found
        fell = f"; the pendulum fell in {found.fell}" * bool(found.fell)
        reason = f"; {found.impossible} impossible: {found.reason}" * bool(found.impossible)
        text = f"{found.runs} runs{fell}{reason}."
        if found.smallest and found.largest:
            text += (
                f" The arm swings least with {self._point(found.smallest)}, and most with "
                f"{self._point(found.largest)}."
            )
        return text

    def _point(self, row: Mapping[str, Any]) -> str:
        values = (f"{name} = {row[name]}" for name in self.found.parameters)
        return f"{', '.join(values)}, by {angle(row[SIZE])}"

    def report(self) -> str:
        """A sentence and the first rows."""
        names = {name: name for name in self.found.parameters}
        fell = {"fell": "fell"} if self.found.fell else {}
        text = self.text(self.found.first, self.found.runs, names | MOTION | fell)
        return f"{text}\n\n{values_text({'file': str(self.file)})}" if self.file else text

    def plot(self, axes: Any = None) -> Any:
        """Draw the arm's swing over the parameters; see :meth:`Result.plot`."""
        from furuta.figures.sweep import draw_runs

        if not self:
            raise ParameterError("the rows of the sweep were not kept")
        return draw_runs(self, self.found.parameters, axes)


class Comparison(Table):
    """Candidates on simulated rigs, a row each, from the best to the worst.

    Columns: ``candidate``; residuals, which are the arm's swing, peak to peak, over the rigs; on
    how many rigs they are worse than without compensation, and by which ratio; what the sensors
    alone cause; falls, commands, delay margin, pushes; and which one is ``recommended``: the best
    here, which moves the command least of those that are accurate and never fell.

    Attributes:
        found: ``candidates``, ``rigs`` and the ``residual`` of each pair (candidates, rigs), which
            is infinite after a fall.
        encoder_count: One count of the arm's encoder [rad].
        candidates: Names and settings.
        impossible: Why some of the rigs are left out, by name.
        best_bandwidths: Rows of the best bandwidth on each rig, where it was asked for.
        runs: A row per run, where they were kept.
        every_column: Whether the report has all columns instead of some.
        by_rig: Whether the report lists each rig, as of the named ones.
    """

    every_column = False
    by_rig = False
    best_bandwidths: Sequence[Mapping[str, Any]] = ()
    runs = Table()

    def __init__(
        self,
        found: comparison.Table,
        encoder_count: float,
        candidates: Sequence[Candidate],
        impossible: Mapping[str, str],
    ) -> None:
        scores = rank(found, encoder_count)
        best = recommended(scores, encoder_count)
        super().__init__(columns(s._asdict() | {"recommended": s is best} for s in scores))
        self.found, self.encoder_count = found, encoder_count
        self.candidates = {each.name: each.settings for each in candidates}
        self.impossible = impossible
        self.best = best.candidate if best else None

    def _by_name(self) -> dict[str, Any]:
        """The ``ranking`` and the best here; of named rigs also each residual."""
        found = self.found
        result: dict[str, Any] = {
            "rigs": len(found.rigs),
            "encoder_count_rad": self.encoder_count,
            "ranking": self.dictionaries(),
            "recommended": self.best,
            "recommended_settings": self.candidates.get(self.best or "", {}),
            "impossible": len(self.impossible),
        }
        if self.by_rig:
            result["rows"] = [
                {"rig": rig, "candidate": candidate, SIZE: float(size)}
                for rig, sizes in zip(found.rigs, found.residual.T, strict=True)
                for candidate, size in zip(found.candidates, sizes, strict=True)
            ]
        if self.best_bandwidths:
            result["best_bandwidths"] = list(self.best_bandwidths)
        return result

    def sentence(self) -> str:
        """Which candidate is best here, and where the setting ``recommended`` stands."""
        rigs, count = f"{len(self.found.rigs)} rigs", angle(self.encoder_count)
        left_out = f" {len(self.impossible)} rigs are impossible and left out."
        if self.best is None:
            text = f"None is best here: with each the pendulum falls on some of the {rigs}."
        else:
            high = self._high(self.best)
            why = f"the least of all; one count of its encoder is {count}"
            if high <= self.encoder_count:
                why = (
                    f"with the smoothest command of those within one count of its encoder, {count}"
                )
            text = (
                f"Best here: {self.best}. On 95 % of {rigs} the arm swings by at most "
                f"{angle(high)}, {why}."
            )
        names = list(self["candidate"])
        if "recommended" in names and self.best != "recommended":
            text += (
                f" The setting named recommended is in place {names.index('recommended') + 1} of "
                f"{len(names)}, with {angle(self._high('recommended'))}."
            )
        return text + left_out * bool(self.impossible)

    def _high(self, candidate: str) -> float:
        return float(self["residual_95_rad"][self["candidate"] == candidate][0])

    def report(self) -> str:
        """A sentence, the ranking, and what is known of each rig."""
        parts = [self.text(self.dictionaries(), self.rows, ALL if self.every_column else CANDIDATE)]
        names = self.found.candidates if self.by_rig else []
        best = self.best_bandwidths or len(self.found.rigs) * [{}]
        if self.by_rig or self.best_bandwidths:
            rows = [
                {"rig": rig, **row, **dict(zip(names, sizes, strict=False))}
                for rig, row, sizes in zip(
                    self.found.rigs, best, self.found.residual.T, strict=True
                )
            ]
            headings = {name: name.replace("_", " ") for name in ("rig", *names)}
            parts += ["Swing of the arm [rad] on each rig; –: the pendulum fell"]
            parts += [table_text(rows, headings | (BEST if self.best_bandwidths else {}))]
        return "\n\n".join(parts)

    def plot(self, axes: Any = None) -> Any:
        """Draw the residuals of each candidate; see :meth:`Result.plot`."""
        from furuta.figures.comparison import draw_comparison

        return draw_comparison(self.found, list(self["candidate"]), self.encoder_count, axes)


@dataclass(frozen=True, repr=False, eq=False)
class SwingUp(Result, StartResults):
    """Swing-ups from random states, on plants that differ from the model.

    Fields: number of ``starts``, ``upright`` by the deadline, ``beyond_limits``; median and worst
    time until upright ``median_s``, ``worst_s``.

    Attributes:
        runs: Of each start the time until upright, NaN if never, the largest angle and speed of the
            arm relative to its limits, whether a limit was exceeded, and for the first starts the
            pendulum's angle over time.
        knocks: Pushes, falls, swing-ups after them, and time upright of a run of 60 s; or None.
    """

    runs: list[SwingUpRun] = field(repr=False)
    knocks: Knocks | None = field(default=None, repr=False)

    def _by_name(self) -> dict[str, Any]:
        """The fields, and those of the knocks."""
        return super()._by_name() | (self.knocks._asdict() if self.knocks else {})

    def sentence(self) -> str:
        """How many starts are upright in time, and whether the limits were kept."""
        knocks = self.knocks
        limits = f"{self.beyond_limits or 'none'} beyond a limit"
        text = f"{self.upright} of {self.starts} starts are upright within {DEADLINE:g} s"
        if self.upright:
            text += f", half of them within {self.median_s:.3g} s"
        text = f"{text}; {limits}."
        if knocks:
            text += (
                f" After {knocks.pushes} pushes the pendulum fell {knocks.falls} times and swung "
                f"up {knocks.swing_ups} times."
            )
        return text

    def plot(self, axes: Any = None) -> Any:
        """Draw angles, times until upright, and the arm within its limits."""
        from furuta.figures.swing_up import draw_swing_up

        return draw_swing_up(self.runs, axes)


@dataclass(frozen=True, repr=False)
class Tuning(Result, trials.TuningResult):
    """A tuning by the arm's swing.

    Fields: the trials ``before`` and ``after``, each with its ``compensation`` (parameters of
    estimator, friction observer and controller) and the arm's ``swing`` [rad]; all ``trials``;
    the ``parameters`` that changed, by node; whether there is a ``gain``; pendulum time
    ``seconds``; and ``encoder_count`` [rad].
    """

    def _by_name(self) -> dict[str, Any]:
        """Changed parameters by node, and all trials."""
        return {
            "parameters": self.parameters,
            "before": _trial(self.before),
            "after": _trial(self.after),
            "trials": [_trial(each) for each in self.trials],
            "gain": self.gain,
            "pendulum_seconds": self.seconds,
        }

    def sentence(self) -> str:
        """How far the arm swings after and before."""
        before, after = self.before, self.after
        count = f"One count of its encoder is {angle(self.encoder_count)}."
        if self.gain:
            was = f" instead of {angle(before.swing)}" if np.isfinite(before.swing) else ""
            return f"The arm swings by {angle(after.swing)}{was}. {count}"
        return (
            f"No gain: nothing is better than the setting as it was, with which the arm swings by "
            f"{angle(before.swing)}. {count}"
        )

    def table(self, values: Mapping[str, Any]) -> str:
        """The parameters that changed, and the trials."""
        after = self.after.compensation
        old = self.before.compensation.changes(after)
        changed = [
            {"parameter": f"{node}.{name}", "before": old[node][name], "after": value}
            for node, of in values["parameters"].items()
            for name, value in of.items()
        ]
        rows = [
            {
                "trial": each.title,
                SIZE: each.swing,
                "remark": "result" if each == self.after else each.remark,
            }
            for each in self.trials
        ]
        headings = {"trial": "trial", SIZE: "arm [rad]", "remark": "remark"}
        tables = [table_text(changed)] if changed else []
        return "\n\n".join([*tables, table_text(rows, headings)])

    def plot(self, axes: Any = None) -> Any:
        """Draw the arm's swing of each trial; see :meth:`Result.plot`."""
        from furuta.figures.tuning import draw_tuning

        return draw_tuning(self, axes)


def _trial(trial: trials.Trial) -> dict[str, Any]:
    return {
        "compensation": trial.name,
        "scale": trial.scale,
        "lag_s": trial.lag,
        "swing_rad": trial.swing,  # of the estimates: no other result has it
        "given_up": trial.given_up,
    }


@dataclass(frozen=True, repr=False, eq=False)
class Demo(Result):
    """The recorded demo: phases with one compensation each, as ``rows`` of what is measured.

    Attributes:
        recorded: Series of the whole run.
        phases: Compensations with their start and end [s].
        encoder_count: One count of the arm's encoder [rad].
        more: What else the dictionary has.
    """

    recorded: RecordedRun
    phases: list[Phase]
    encoder_count: float
    more: Mapping[str, Any]

    @cached_property
    def rows(self) -> list[dict[str, Any]]:
        """What is measured of each phase."""
        return evaluate(self.phases, self.recorded)

    def _by_name(self) -> dict[str, Any]:
        """The ``runs``, one per phase, and what else is known."""
        return {"runs": self.rows, **self.more}

    def sentence(self) -> str:
        """How far the arm swings with the first and the last compensation."""
        first, *_, last = self.rows
        period = first["period_s"]
        every = f" every {period:.3g} s" if np.isfinite(period) else ""
        return (
            f"The arm swings by {angle(first[SIZE])}{every} with compensation "
            f"{first['compensation']}, and by {angle(last[SIZE])} with {last['compensation']}. One "
            f"count of its encoder is {angle(self.encoder_count)}."
        )

    def table(self, values: Mapping[str, Any]) -> str:
        """A row per phase, and the files."""
        headings = {
            "compensation": "compensation",
            **MOTION,
            "command_rms_v": "u rms [V]",
            "wall_seconds": "took [s]",
        }
        files = {name: values[name] for name in ("figure", "bag") if name in values}
        return f"{table_text(self.rows, headings)}\n\n{values_text(files)}"

    def plot(self, axes: Any = None) -> Any:
        """Draw the phases beside each other; see :meth:`Result.plot`."""
        from furuta.figures.series import draw_demo

        return draw_demo(self.recorded, self.phases, self.rows, self.encoder_count, axes)
