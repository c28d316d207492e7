"""Covariance from the errors of the sensors, for short segments."""

from __future__ import annotations

import numpy as np

from furuta_identification.shooting.shooting import Shooting
from furuta_identification.uncertainty.sensor_errors import measured_again, sensor_errors

# Number of synthetic recordings.
REPLICATES = 200


def sensor_covariance(
    shooting: Shooting, vector: np.ndarray, residuals: np.ndarray, gain: np.ndarray
) -> np.ndarray:
    """Covariance of the parameters if the sensors measured the model's motion many times.

    This is a parametric bootstrap (Efron and Tibshirani 1993, ch. 6.5), linearised by ``gain``. In
    a periodic motion the quantisation errors of an encoder repeat in each period. The fit absorbs
    them, so the scatter of the residuals does not show them.
    """
    rng = np.random.default_rng(0)
    predicted = shooting.predictions(vector)
    errors = [sensor_errors(part.recording) for part in shooting.parts]
    shifts, sizes = [], []
    for _ in range(REPLICATES):
        error = np.concatenate(
            [
                shooting.weighted(i, measured_again(y, each, rng) - y)
                for i, (y, each) in enumerate(zip(predicted, errors, strict=True))
            ]
        )
        shifts.append(gain @ error)
        sizes.append(np.median(error[error != 0.0] ** 2))
    # Larger residuals than the sensors explain widen the covariance. By medians: one segment that
    # the model does not follow must not count for the others.
    excess = max(1.0, float(np.median(residuals[residuals != 0.0] ** 2) / np.median(sizes)))
    covariance: np.ndarray = excess * np.cov(np.array(shifts).T)
    return covariance
