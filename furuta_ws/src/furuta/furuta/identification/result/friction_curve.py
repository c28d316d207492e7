"""Friction over speed, as the law of a fit and as the recordings show it."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

# Fewest and most bins of the speed, usual samples in one, and fewest that tell anything.
FEWEST_BINS, MOST_BINS, USUAL, FEWEST = 10, 40, 8.0, 2.0
# Speeds in either direction at which the law is computed.
POINTS = 200
# Step of the finite differences, in standard errors.
STEP = 1e-3


class FrictionCurve(NamedTuple):
    """A law of friction over speed, with what recordings show of it.

    ``law`` and its standard ``error`` (k,) belong to ``speed`` (k,). ``measured`` (b,) are means
    over bins about ``measured_speed`` (b,), with the standard errors ``scatter`` (b,). ``units``
    are those of speed and friction, and ``shown`` says what belongs to it.
    """

    speed: np.ndarray
    law: np.ndarray
    error: np.ndarray
    measured_speed: np.ndarray
    measured: np.ndarray
    scatter: np.ndarray
    units: tuple[str, str]
    shown: str = "friction"


class Followed(NamedTuple):
    """A position or speed (n,), measured and fitted, over time [s]; NaN between segments."""

    time: np.ndarray
    measured: np.ndarray
    fitted: np.ndarray
    unit: str


def friction_curve(
    law: Callable[[np.ndarray, np.ndarray], np.ndarray],
    vector: np.ndarray,
    covariance: np.ndarray,
    samples: tuple[np.ndarray, np.ndarray],
    overlap: float,
    units: tuple[str, str],
) -> FrictionCurve:
    """The curve of a fit.

    Args:
        law: Friction (k,) of a vector of unknowns (p,) at speeds (k,).
        vector: The fitted unknowns (p,).
        covariance: That of the unknowns (p, p).
        samples: Speeds (n,) and measured friction (n,).
        overlap: Samples that inform as one.
        units: Those of speed and friction.
    """
    speeds, friction = samples
    fastest = float(np.max(np.abs(speeds), initial=0.0)) or 1.0
    side = np.linspace(0.0, fastest, POINTS + 1)[1:]
    grid = np.concatenate((-side[::-1], side))
    base, errors = law(vector, grid), np.sqrt(np.maximum(np.diag(covariance), 0.0))
    slopes = np.zeros((len(grid), len(vector)))
    for k, error in enumerate(errors):
        if error > 0.0:
            there = vector + STEP * error * (np.arange(len(vector)) == k)
            slopes[:, k] = (law(there, grid) - base) / (STEP * error)
    variance = np.sum((slopes @ covariance) * slopes, axis=1)
    return FrictionCurve(
        grid,
        base,
        np.sqrt(np.maximum(variance, 0.0)),
        *_binned(speeds, friction, fastest, overlap),
        units,
    )


def _binned(
    speeds: np.ndarray, friction: np.ndarray, fastest: float, overlap: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Means of speed and friction over bins of the speed, and the standard errors."""
    wanted = len(speeds) / max(overlap, 1.0) / USUAL
    count = 2 * round(0.5 * min(max(wanted, FEWEST_BINS), MOST_BINS))  # no bin on both sides of 0
    bins = np.clip(np.floor((speeds / fastest + 1.0) * 0.5 * count), 0, count - 1)
    rows = []
    for number in range(count):
        own = friction[bins == number]
        informative = len(own) / max(overlap, 1.0)
        if informative >= FEWEST:
            error = np.std(own) / np.sqrt(informative)
            rows.append((np.mean(speeds[bins == number]), np.mean(own), error))
    speed, mean, error = np.array(rows, dtype=float).reshape(-1, 3).T
    return speed, mean, error
