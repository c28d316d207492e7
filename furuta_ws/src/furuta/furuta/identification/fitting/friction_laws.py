"""Compares laws of the arm's friction: each is fitted to some recordings and predicts the others.

A law with more parameters always fits better. It describes the arm only if it also predicts better
what it was not fitted to.
"""

import math
from collections.abc import Callable, Iterable
from functools import cache
from typing import NamedTuple

import numpy as np

from furuta.identification.fitting.swinging import fit_growing_segments
from furuta.identification.model import Model
from furuta.identification.options import silent
from furuta.identification.regression.speeds import turns_one_way
from furuta.identification.shooting.unknowns import LUGRE, ParameterValues
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError
from furuta_recordings.recording import Recording, by_run

BASE = "coulomb"
_SIMPLE = ("viscous", "coulomb")


# The unknowns of each law's friction, and the law from whose optimum its fit starts. That law is a
# special case: a fit cannot end worse than it started.
LAWS: dict[str, tuple[tuple[str, ...], str]] = {
    "viscous": (("viscous",), ""),
    BASE: (_SIMPLE, ""),
    "asymmetric": ((*_SIMPLE, "asymmetry"), BASE),
    "stribeck": ((*_SIMPLE, "alpha1", "stribeck_velocity"), BASE),
    "lugre": ((*_SIMPLE, *LUGRE), "stribeck"),
}
# Values of the arm's friction where a law does not have the unknown. The bristle of the paper's arm
# stands for sticking in all laws but LuGre's.
NEUTRAL = {
    "coulomb": 0.0,
    "asymmetry": 0.0,
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
    best = min(result.mean_error for result in results)
    good = [result for result in results if (1.0 - CLEARLY) * result.mean_error <= best]
    return min(good, key=lambda result: (result.parameters, result.mean_error))


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
    if all(turns_one_way(recording) for recording in model.recordings):
        raise ParameterError(
            "the arm turns in one direction only: laws of friction need reversals of the arm"
        )
    parts, laws = _parts(model.recordings), list(laws)
    model = model._replace(window=min(model.window, LONGEST))
    errors: dict[str, dict[str, float]] = {law: {} for law in laws}
    for name, held_out in parts.items():
        fits = _fits(model, [r for other, part in parts.items() if other != name for r in part])
        base = _error(model, fits(BASE), held_out)
        for law in laws:
            report(f"predicting {name} with the law {law}")
            errors[law][name] = _error(model, fits(law), held_out) / base
    return [LawResult(law, len(LAWS[law][0]), errors[law]) for law in laws]


def _parts(recordings: list[Recording]) -> dict[str, list[Recording]]:
    """What is held out in turn, by name: the recordings, or the halves of a single one."""
    runs = by_run(recordings)
    if len(runs) > 1:
        return {run[0].name: run for run in runs}
    if len(recordings) > 1:
        middle = len(recordings) // 2
        return {"first half": recordings[:middle], "second half": recordings[middle:]}
    (only,) = recordings
    middle_time = only.time[0] + 0.5 * only.duration
    return {
        "first half": [only.between(-np.inf, middle_time)],
        "second half": [only.between(middle_time, np.inf)],
    }


def _fits(model: Model, recordings: list[Recording]) -> Callable[[str], ParameterValues]:
    """The values of each law, fitted to some of a model's recordings.

    The fit of a law starts from the optimum of the law that it contains.
    """
    held_out = {r.number for r in model.recordings} - {r.number for r in recordings}
    friction = {"viscous", *NEUTRAL, *(("zero", number) for number in held_out)}
    other = [key for key in model.fitted if key not in friction]

    @cache
    def fitted(law: str) -> ParameterValues:
        unknowns, contained = LAWS[law]
        start = fitted(contained) if contained else model.values
        neutral = {name: value for name, value in NEUTRAL.items() if name not in unknowns}
        start = start.changed(list(neutral), list(neutral.values()))
        keys = [*other, *unknowns]
        return fit_growing_segments(recordings, keys, start, model.window, model.scale).values

    return fitted


def _error(model: Model, values: ParameterValues, recordings: list[Recording]) -> float:
    """Root mean square of the weighted residuals of all measured channels."""
    fitted = model._replace(values=values)
    residuals = [r.measured - fitted.predict(r).predicted for r in recordings]
    return float(np.sqrt(np.nanmean((np.concatenate(residuals) / model.scale) ** 2)))
