"""How well predicted series agree with measured ones, in percent."""

from __future__ import annotations

import numpy as np

from furuta_identification.fitting.optimisation import Optimum
from furuta_model.state import THETA

# Standard deviation of a series [rad, rad/s] below which nothing moves in it.
SMALLEST_MOTION = 1e-6


def fit_percent(measured: np.ndarray, predicted: np.ndarray) -> float:
    """100·(1 − ‖y − ŷ‖/‖y − ȳ‖) [%]; NaN for a series (n,) without values or without motion."""
    here = np.isfinite(measured)
    y, y_hat = measured[here], predicted[here]
    if not len(y) or np.std(y) < SMALLEST_MOTION:
        return float("nan")
    return float(100.0 * (1.0 - np.linalg.norm(y - y_hat) / np.linalg.norm(y - np.mean(y))))


def worst_pendulum_fit(optimum: Optimum) -> float:
    """The smallest fit of the pendulum's angle [%] over the recordings."""
    predictions = optimum.shooting.predictions(optimum.vector)
    return min(
        fit_percent(part.recording.measured[:, THETA], predicted[:, THETA])
        for part, predicted in zip(optimum.shooting.parts, predictions, strict=True)
    )
