"""What a fit of any body returns: values with standard errors, what is left over, and a verdict."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from furuta.identification.axis.segments import forced_motion, segmented
from furuta.identification.bodies.body import Body, Segments
from furuta.identification.estimates import Estimates
from furuta.identification.least_squares import Fit, Problem, fit
from furuta.identification.selection import chance_of, significance
from furuta.identification.unknowns import Key, Unknowns, field_of, name_of
from furuta.identification.verdict import DOUBTFUL, Residual
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI
from furuta_recordings.cleaning import cleaned
from furuta_recordings.recording import Recording
from furuta_recordings.splitting import split_into_runs

# Probability by chance up to which a value is reported, and what is said of one that may be 0.
BY_CHANCE, NOT_DISTINGUISHABLE = 1e-3, "not distinguishable from 0"
# Fewest segments for each unknown, and largest relative standard error of a usable inertia.
FEWEST_SEGMENTS, LARGEST_ERROR = 2.0, 0.2


@dataclass(frozen=True, repr=False, eq=False)
class Fitted(Estimates):
    """What recordings tell of a joint.

    ``names`` and ``covariance`` (p, p) are those of all fitted unknowns, in the order of ``fit``.
    ``residual`` is what the model leaves. ``body`` is None if not the motion but the torque was
    fitted.
    """

    names: tuple[str, ...]
    covariance: np.ndarray
    residual: Residual
    recordings: tuple[Recording, ...] = field(repr=False)
    fit: Fit = field(repr=False)
    body: Body | None = field(repr=False)

    def unit(self, name: str) -> str:
        """The unit of a value; empty for a number."""
        return self.units.get(name, "")

    def predict(self, recording: Recording) -> np.ndarray:
        """Positions (n,) of free runs at the times of a recording, in its unit.

        A run gets the command, but the position only at its start. NaN in pauses between runs.

        Raises:
            ParameterError: The torque was fitted, which predicts no motion.
        """
        positions = np.full(len(recording.time), np.nan)
        for run in self._runs(recording):
            ready, origin = self._prepared(run)
            cut, found = self._free_run(ready)
            there = (recording.time >= run.time[0]) & (recording.time <= run.time[-1])
            moved = cut.measured[:, 0] - found.state.residuals[:, 0] / cut.weight[:, 0]
            positions[there] = np.interp(recording.time[there] - origin, cut.time, moved)
        return positions

    def error(self, recording: Recording, own_offset: bool = False) -> float:
        """Root mean square error of :meth:`predict` over the runs, in the unit of position.

        The offset is that of the fit, or each run's ``own_offset``.
        """
        return self._error(recording, (("offset", 0),) if own_offset else ())

    def _error(self, recording: Recording, free: Sequence[Key]) -> float:
        """With some unknowns ``free``, which each run fits."""
        runs = self._runs(recording)
        squares = []
        for run in runs:
            cut, found = self._free_run(self._prepared(run)[0], free)
            squares.append(len(run.time) * (found.rms * cut.noise) ** 2)
        return float(np.sqrt(np.sum(squares) / sum(len(run.time) for run in runs)))

    def _runs(self, recording: Recording) -> list[Recording]:
        """What is between the pauses of a recording."""
        if self.body is None:
            raise ParameterError("the torque was fitted, which predicts no motion")
        try:
            return split_into_runs(recording)
        except ParameterError:  # all are short
            return [recording]

    def _free_run(self, ready: Recording, free: Sequence[Key] = ()) -> tuple[Segments, Fit]:
        """A prepared run as one segment, and its fit of what is ``free``."""
        assert self.body is not None
        cut = segmented([ready], np.inf)
        unknowns, values = self._unknowns(free), self._for_others()
        return cut, fit(Problem(self.body, cut, unknowns), values)

    def _prepared(self, run: Recording) -> tuple[Recording, float]:
        """A run ready for a fit, and the time [s] that is 0 in it."""
        return cleaned(run, joints=(PHI,)), 0.0

    def _unknowns(self, free: Sequence[Key]) -> Unknowns:
        return Unknowns(each for each in self.fit.unknowns if each.key in free)

    def _for_others(self) -> dict[Key, float]:
        """The values without what belongs to one recording: offsets but the first, and drift."""
        others = {("offset", number) for number in range(1, len(self.recordings))}
        known = {key: value for key, value in self.fit.values.items() if key not in others}
        return {**known, "drift": 0.0}

    def _by_name(self) -> dict[str, Any]:
        values = super()._by_name()
        findings = values.pop("findings")
        covariance = {"names": list(self.names), "values": self.covariance}
        return {
            **values,
            "covariance": covariance,
            "residual": self.residual._asdict(),
            "findings": findings,
        }


class Report(NamedTuple):
    """Values and standard errors of what is determined, and why the rest is not."""

    values: dict[str, float]
    errors: dict[str, float]
    undetermined: dict[str, str]

    def add(self, name: str, value: float, error: float, certain: bool) -> None:
        """A value with its standard error, if it is ``certain`` that it is not 0."""
        self.remove(name)
        if certain:
            self.values[name], self.errors[name] = value, error
        else:
            self.undetermined[name] = f"{value:.3g} ± {error:.2g}: {NOT_DISTINGUISHABLE}"

    def remove(self, name: str) -> None:
        """Nothing is said of it."""
        for each in self:
            each.pop(name, None)

    def withhold(self, reasons: Mapping[str, str]) -> None:
        """What is not determined, by name."""
        for name, reason in reasons.items():
            self.remove(name)
            self.undetermined[name] = reason


def reported(
    best: Fit,
    covered: np.ndarray,
    groups: Mapping[Key, Iterable[Sequence[Key]]],
    named: Mapping[Key, str],
) -> Report:
    """What a fit tells.

    All ``groups`` of unknowns that a value has must be distinguishable from 0; an offset may be 0.
    """
    found = Report({}, {}, {})
    sizes = best.unknowns.all("size")
    for key, size, own in zip(best.keys, sizes, np.sqrt(np.diag(covered)), strict=True):
        certain = all(
            chance_of(best, group, covered) < BY_CHANCE for group in groups.get(key, [(key,)])
        )
        certain |= field_of(key) == "offset" and own < 1.0
        name = named.get(key, name_of(key))
        found.add(name, float(best.values[key]), float(size * own), certain)
    return found


def is_certain(value: float, error: float, blocks: int) -> bool:
    """Whether a value is distinguishable from 0."""
    return significance(np.array([value]), np.array([[error**2]]), blocks) < BY_CHANCE


def doubts_of(
    best: Fit, residual: Residual, report: Report, needed: bool = True
) -> Iterator[tuple[str, str]]:
    """What makes values less usable, of any body: each a grade and its reason.

    The inertia may be ``needed``.
    """
    yield from residual.doubts()
    segments, unknown = best.segments, best.determined
    if segments < FEWEST_SEGMENTS * unknown:
        yield DOUBTFUL, f"{segments} segments for {unknown:.0f} unknowns: record for longer"
    inertia = report.values.get("inertia", 0.0) if needed else np.inf
    error = report.errors.get("inertia", 0.0)
    if not inertia:
        yield DOUBTFUL, "the inertia is not determined: record a motion that accelerates"
    elif error > LARGEST_ERROR * inertia:
        yield DOUBTFUL, f"the inertia is known to {100.0 * error / inertia:.0f} % only"


def residual_of(best: Fit, cut: Segments, sensor: float) -> Residual:
    """What a fit leaves of the motion that forces cause, and in the noise of the ``sensor``."""
    left = best.rms * cut.noise
    return Residual("motion", left / sensor, left / forced_motion(cut))


def natural(best: Fit, covered: np.ndarray) -> np.ndarray:
    """A covariance (p, p) in sizes, in the units of the values."""
    sizes = best.unknowns.all("size")
    return np.asarray(covered * np.outer(sizes, sizes))
