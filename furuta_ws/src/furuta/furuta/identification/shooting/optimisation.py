"""Nonlinear least squares over the unknowns, and how large the residuals are."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from furuta.identification.shooting.segments import cut_into_segments
from furuta.identification.shooting.shooting import Shooting
from furuta.identification.shooting.unknowns import ParameterValues, bounds, prior
from furuta_model.state import THETA
from furuta_recordings.recording import Recording

MOST_EVALUATIONS = 40
# Standard deviation of a series [rad, rad/s] below which nothing moves in it.
SMALLEST_MOTION = 1e-6
# Relative change of the sum of squares at which a fit ends: the last fit, and one on the way.
FINE, COARSE = 1e-9, 1e-4
# Distance of a start from its bounds, in standard deviations of the prior.
INSIDE = 0.05
# Consecutive samples that carry the information of one, where errors of the model dominate noise.
CORRELATED_SAMPLES = 100.0


class Optimum(NamedTuple):
    """The result of an optimisation: ``values`` and their ``vector`` of the fitted unknowns.

    ``window`` [s] is the length of the segments.
    """

    values: ParameterValues
    shooting: Shooting
    vector: np.ndarray
    window: float

    @property
    def names(self) -> list[str]:
        """The fitted unknowns."""
        return self.shooting.names

    @property
    def recordings(self) -> list[Recording]:
        """The fitted recordings."""
        return [part.recording for part in self.shooting.parts]

    @property
    def scale(self) -> np.ndarray:
        """The residual of each channel that counts as one (4,)."""
        return self.shooting.parts[0].scale

    @property
    def predictions(self) -> list[tuple[Recording, np.ndarray]]:
        """The recordings with what is predicted for them (n, 4)."""
        return list(zip(self.recordings, self.shooting.predictions(self.vector), strict=True))

    def refitted(
        self, names: list[str], start: ParameterValues, tolerance: float = COARSE
    ) -> Optimum:
        """A fit of the same recordings with other unknowns or from another start."""
        return optimise(
            self.recordings, names, start, self.window, self.scale, True, tolerance=tolerance
        )


def optimise(
    recordings: list[Recording],
    names: list[str],
    start: ParameterValues,
    window: float,
    scale: np.ndarray,
    robust: bool,
    tolerance: float = COARSE,
) -> Optimum:
    """Fit the unknowns ``names``; ``robust`` limits the influence of large residuals."""
    parts = [cut_into_segments(r, window, scale, start) for r in recordings]
    shooting = Shooting(parts, names, start)
    low, high = bounds(start, names)
    mean, spread = prior(names)
    # A start at a bound would hold the optimiser there.
    margin = np.where(np.isfinite(spread), INSIDE * spread, 1e-9 * np.maximum(1.0, high - low))
    best = least_squares(
        lambda x: np.append(shooting.residuals(x), (x - mean) / spread),
        np.clip(start.vector(names), low + margin, high - margin),
        jac=lambda x: np.vstack((shooting.slopes(x), np.diag(1.0 / spread))),
        bounds=(low, high),
        x_scale="jac",
        loss="soft_l1" if robust else "linear",
        ftol=tolerance,
        xtol=0.1 * tolerance,
        max_nfev=MOST_EVALUATIONS,
    )
    return Optimum(start.changed(names, best.x), shooting, best.x, window)


def residual_scale(optimum: Optimum) -> np.ndarray:
    """Root mean square of each channel's residuals (4,), widened for their correlation in time."""
    residuals = np.concatenate([r.measured - predicted for r, predicted in optimum.predictions])
    count = np.sum(np.isfinite(residuals), axis=0)
    size = np.sqrt(np.nansum(residuals**2, axis=0) / np.maximum(count, 1))
    size = np.where(count > 0, size, 1.0)
    widened: np.ndarray = np.maximum(np.sqrt(CORRELATED_SAMPLES) * size, 1e-4)
    return widened


def fit_percent(measured: np.ndarray, predicted: np.ndarray) -> float:
    """100·(1 − ‖y − ŷ‖/‖y − ȳ‖) [%]; NaN for a series (n,) without values or without motion."""
    here = np.isfinite(measured)
    y, y_hat = measured[here], predicted[here]
    if not len(y) or np.std(y) < SMALLEST_MOTION:
        return float("nan")
    return float(100.0 * (1.0 - np.linalg.norm(y - y_hat) / np.linalg.norm(y - np.mean(y))))


def worst_pendulum_fit(optimum: Optimum) -> float:
    """The smallest fit of the pendulum's angle [%] over the recordings."""
    return min(
        fit_percent(r.measured[:, THETA], predicted[:, THETA])
        for r, predicted in optimum.predictions
    )
