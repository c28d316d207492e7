"""Compares laws of the arm's friction: each is fitted to some recordings and predicts the others.

A law with more parameters always fits better. It describes the arm only if it also predicts better
what it was not fitted to.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from furuta_identification.fitting.coulomb import turns_one_way
from furuta_identification.fitting.model import Model
from furuta_identification.fitting.optimisation import Optimum, best_of
from furuta_identification.fitting.starting_fits import fit_growing_segments
from furuta_identification.fitting.validation import predict_prepared
from furuta_identification.preparation.options import silent
from furuta_identification.shooting.parameter_values import ParameterValues
from furuta_identification.shooting.unknowns import LUGRE, zero_name
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError
from furuta_recordings.recording import Recording

BASE = "coulomb"
_SIMPLE = ("viscous", "coulomb")


class Law(NamedTuple):
    """A law: the unknowns of its friction, and the law that it contains as a special case."""

    unknowns: tuple[str, ...]
    contains: str = ""


LAWS = {
    "viscous": Law(("viscous",)),
    BASE: Law(_SIMPLE, "viscous"),
    "asymmetric": Law((*_SIMPLE, "asymmetry"), BASE),
    "load-dependent": Law((*_SIMPLE, "load"), BASE),
    "stribeck": Law((*_SIMPLE, "alpha1", "stribeck_velocity"), BASE),
    "lugre": Law((*_SIMPLE, *LUGRE), "stribeck"),
}
# Values of the arm's friction where a law does not have the unknown. The bristle of the paper's arm
# stands for sticking in all laws but LuGre's.
NEUTRAL = {
    "coulomb": 0.0,
    "asymmetry": 0.0,
    "load": 0.0,
    "alpha1": 0.0,
    "stribeck_velocity": math.log(Friction().stribeck_velocity),
    "sigma0": math.log(Friction().sigma0),
    "sigma1": math.log(Friction().sigma1),
}
# Longest prediction [s]. Over longer ones a pendulum that turns over the top is chaotic: fits end
# in local optima, and the errors tell nothing of friction.
LONGEST = 0.3
# Part by which a law with more parameters must lower the error to be carried by the data.
CLEARLY = 0.02


class LawResult(NamedTuple):
    """Errors of a law's predictions of held-out parts, by name, over those of Coulomb's law."""

    law: str
    parameters: int
    errors: dict[str, float]

    @property
    def mean_error(self) -> float:
        """The geometric mean of the errors."""
        return float(np.exp(np.mean(np.log(list(self.errors.values())))))


def simplest_adequate_law(results: list[LawResult]) -> LawResult:
    """The law with the fewest parameters that no other predicts clearly better than."""
    best = min(each.mean_error for each in results)
    good = [each for each in results if (1.0 - CLEARLY) * each.mean_error <= best]
    return min(good, key=lambda each: (each.parameters, each.mean_error))


def compare_laws(
    model: Model, report: Callable[[str], None] = silent, laws: Iterable[str] = tuple(LAWS)
) -> list[LawResult]:
    """Each of the ``laws`` by its predictions of held-out recordings, compared to Coulomb's law.

    It is fitted to all recordings but one, which it predicts in pieces of 0.3 s, in turn for each.
    Of a single one the halves predict each other. All other unknowns are fitted too, except the
    zero of a held-out recording, which stays that of ``model``. The errors are root mean squares of
    arm and pendulum in units of the model's residuals. ``report`` gets what is in work.

    Raises:
        ParameterError: The arm turns in one direction only, where no law differs from another.
    """
    if all(turns_one_way(each) for each in model.recordings):
        raise ParameterError(
            "the arm turns in one direction only: laws of friction need reversals of the arm"
        )
    parts, laws = _parts(model.recordings), list(laws)
    model = model._replace(window=min(model.window, LONGEST))
    errors: dict[str, dict[str, float]] = {law: {} for law in laws}
    for name, held_out in parts.items():
        fits = _Fits(model, [each for n, part in parts.items() if n != name for each in part])
        base = _error(model, fits.of(BASE), held_out)
        for law in laws:
            report(f"predicting {name} with the law {law}")
            errors[law][name] = _error(model, fits.of(law), held_out) / base
    return [LawResult(law, len(LAWS[law].unknowns), errors[law]) for law in laws]


def _parts(recordings: list[Recording]) -> dict[str, list[Recording]]:
    """What is held out in turn, by name: the recordings, or the halves of a single one."""
    numbers = sorted({each.number for each in recordings})
    if len(numbers) > 1:
        groups = [[each for each in recordings if each.number == number] for number in numbers]
        return {group[0].name: group for group in groups}
    if len(recordings) > 1:
        middle = len(recordings) // 2
        return {"first half": recordings[:middle], "second half": recordings[middle:]}
    (only,) = recordings
    middle_time = only.time[0] + 0.5 * only.duration
    return {
        "first half": [only.between(-np.inf, middle_time)],
        "second half": [only.between(middle_time, np.inf)],
    }


class _Fits:
    """The laws fitted to some of a model's recordings."""

    def __init__(self, model: Model, recordings: list[Recording]) -> None:
        self._model, self._recordings = model, recordings
        numbers = {each.number for each in model.recordings} - {each.number for each in recordings}
        friction = {"viscous", *NEUTRAL, *(zero_name(number) for number in numbers)}
        self._other = [name for name in model.fitted if name not in friction]
        self._found: dict[str, Optimum] = {}

    def of(self, law: str) -> ParameterValues:
        """The values of a law at the better of two optima.

        One is reached from the model's values, the other from the optimum of the law that this law
        contains: it cannot fit worse than that one.
        """
        if law not in self._found:
            contained = LAWS[law].contains
            starts = [self._model.values, *([self.of(contained)] if contained else [])]
            self._found[law] = best_of(self._optimum(LAWS[law].unknowns, each) for each in starts)
        return self._found[law].values

    def _optimum(self, unknowns: tuple[str, ...], start: ParameterValues) -> Optimum:
        neutral = {name: value for name, value in NEUTRAL.items() if name not in unknowns}
        start = start.changed(list(neutral), list(neutral.values()))
        return fit_growing_segments(
            self._recordings,
            [*self._other, *unknowns],
            start,
            self._model.window,
            self._model.scale,
        )


def _error(model: Model, values: ParameterValues, recordings: list[Recording]) -> float:
    """Root mean square of the weighted residuals of all measured channels."""
    squares = []
    for each in recordings:
        predicted = predict_prepared(model._replace(values=values), each).predicted
        squares.append(((each.measured - predicted) / model.scale) ** 2)
    return float(np.sqrt(np.nanmean(np.concatenate(squares))))
