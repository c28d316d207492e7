"""Covariance of the fitted parameters: prior, noise, model errors, assumed values."""

from __future__ import annotations

import numpy as np

from furuta_identification.shooting.shooting import Shooting
from furuta_identification.shooting.unknowns import prior_information
from furuta_identification.uncertainty.bootstrap import sensor_covariance
from furuta_identification.uncertainty.jackknife import block_covariance
from furuta_identification.uncertainty.torque_waves import wave_slopes


def covariance_and_information(
    shooting: Shooting, vector: np.ndarray, assumed: dict[str, float], swinging: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Covariance of the unknowns, then of the ``assumed`` ones (name: spread); and information.

    The information is that of the data alone. The covariance is a sum:

    - the part of the prior;
    - for short segments, the effect of the sensors' errors (:func:`sensor_covariance`);
    - for a ``swinging`` pendulum, the scatter between blocks of time (:func:`block_covariance`) and
      the effect of a torque that varies with the arm's angle (:func:`wave_slopes`);
    - the effect of an error of the assumed values.
    """
    slopes, residuals = shooting.slopes(vector), shooting.residuals(vector)
    information = slopes.T @ slopes
    of_prior = prior_information(shooting.names)
    inverse = np.linalg.pinv(information + of_prior)
    gain = inverse @ slopes.T
    covariance = inverse @ of_prior @ inverse
    if all(len(part.starts) > 1 for part in shooting.parts):
        covariance += sensor_covariance(shooting, vector, residuals, gain)
    if swinging:
        covariance += block_covariance(shooting, slopes, residuals, information + of_prior)
        waves = wave_slopes(shooting, vector, residuals)
        if waves is not None:
            shifts = gain @ waves
            covariance += shifts @ shifts.T
    return _with_assumed(shooting, vector, assumed, covariance, information, gain)


def _with_assumed(
    shooting: Shooting,
    vector: np.ndarray,
    assumed: dict[str, float],
    covariance: np.ndarray,
    information: np.ndarray,
    gain: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Both matrices enlarged by the assumed values and by what their errors change."""
    for name, spread in assumed.items():
        shift = -gain @ _slope_in(shooting, vector, name, spread) * spread
        n = len(covariance)
        covariance = np.pad(covariance, ((0, 1), (0, 1)))
        information = np.pad(information, ((0, 1), (0, 1)))
        covariance[:n, :n] += np.outer(shift[:n], shift[:n])
        covariance[n, :n] = covariance[:n, n] = shift[:n] * spread
        covariance[n, n] = spread**2
        gain = np.vstack((gain, np.zeros(gain.shape[1])))
    return covariance, information


def _slope_in(shooting: Shooting, vector: np.ndarray, name: str, spread: float) -> np.ndarray:
    """∂residuals/∂(assumed value)."""
    step = 0.01 * spread
    values = shooting.values.changed([name], [shooting.values.coordinates[name] + step])
    changed = Shooting(shooting.parts, shooting.names, values)
    return (changed.residuals(vector) - shooting.residuals(vector)) / step
