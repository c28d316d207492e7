"""Least squares of a shooting's residuals over its unknowns."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from furuta_identification.shooting.shooting import Shooting, stretches
from furuta_identification.shooting.unknowns import Guess, bounds
from furuta_identification.uncertainty.uncertainty import prior
from furuta_recordings.recording import Recording

MOST_ROUNDS = 40
# Relative change of the sum of squares at which a fit ends, and one that is only a step to it.
EXACT, NEAR = 1e-9, 1e-4
# Samples in a row that tell as much as one where the model's errors, not noise, are left.
CORRELATED = 100.0


class Fitted(NamedTuple):
    """Where the unknowns of a shooting ended."""

    guess: Guess
    shooting: Shooting
    vector: np.ndarray


def optimise(
    recordings: list[Recording],
    names: list[str],
    guess: Guess,
    window: float,
    scale: np.ndarray,
    robust: bool = False,
    tolerance: float = EXACT,
) -> Fitted:
    """Fit the unknowns ``names``; ``robust`` bounds the pull of large residuals."""
    parts = [stretches(each, window, scale, guess) for each in recordings]
    shooting = Shooting(parts, names, guess)
    low, high = bounds(guess, names)
    mean, spread = prior(names)
    margin = 1e-9 * np.maximum(1.0, high - low)
    best = least_squares(
        lambda x: np.append(shooting.residuals(x), (x - mean) / spread),
        np.clip(guess.vector(names), low + margin, high - margin),
        jac=lambda x: np.vstack((shooting.slopes(x), np.diag(1.0 / spread))),
        bounds=(low, high),
        x_scale="jac",
        loss="soft_l1" if robust else "linear",
        ftol=tolerance,
        xtol=0.1 * tolerance,
        max_nfev=MOST_ROUNDS,
    )
    return Fitted(guess.changed(names, best.x), shooting, best.x)


def residual_scale(shooting: Shooting, vector: np.ndarray) -> np.ndarray:
    """What each channel leaves (4,), widened because the samples' errors go together."""
    errors = [
        part.recording.measured - predicted
        for part, predicted in zip(shooting.parts, shooting.predictions(vector), strict=True)
    ]
    every = np.concatenate(errors)
    count = np.sum(np.isfinite(every), axis=0)
    size = np.sqrt(np.nansum(every**2, axis=0) / np.maximum(count, 1))
    size = np.where(count > 0, size, 1.0)
    widened: np.ndarray = np.maximum(np.sqrt(CORRELATED) * size, 1e-4)
    return widened


def misfit(shooting: Shooting, vector: np.ndarray) -> float:
    """Weighted sum of what is left, no residual counting for more than a few."""
    return float(np.sum(np.log1p(shooting.residuals(vector) ** 2)))
