"""State estimate from the sensors, by the paper's filter or a Kalman filter.

Measurement and estimate are (5,): x, then the applied torque and the estimated friction [V].
"""

from __future__ import annotations

from functools import lru_cache
from math import isnan, nan
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled
from furuta_model.state import EFFORT, PHI, PHI_DOT, SIGNALS, THETA, THETA_DOT

from .kalman import fuse, half_count, sample_kalman
from .lowpass import MEMORY as LOWPASS_MEMORY
from .lowpass import sample_lowpass, smooth
from .parameters import EstimatorParameters

# The estimator's memory: that of the low-pass, the Kalman filter's signals, whether it began.
MEMORY = LOWPASS_MEMORY + SIGNALS + 1


class Estimator(NamedTuple):
    """What :func:`estimate_state` computes with."""

    kalman: bool
    ideal: bool
    lowpass_step: np.ndarray
    kalman_step: np.ndarray
    half_count: float


@lru_cache(maxsize=64)
def estimator(p: EstimatorParameters) -> Estimator:
    """The estimator that the parameters describe; kept, for its design takes a millisecond."""
    return Estimator(
        p.method == "kalman",
        p.sensors.ideal,
        sample_lowpass(p),
        sample_kalman(p),
        half_count(p.sensors),
    )


@compiled
def estimate_state(
    memory: np.ndarray, measurement: np.ndarray, p: Estimator, estimate: np.ndarray
) -> None:
    """One sample: ``memory`` is updated, ``estimate`` (5,) written.

    Both filters run, so that a change of method finds the other in step. Without an applied
    torque (NaN) the Kalman filter has no past: it begins anew at every sample.
    """
    lowpass = memory[:LOWPASS_MEMORY]
    signals = memory[LOWPASS_MEMORY : LOWPASS_MEMORY + SIGNALS]
    began = memory[LOWPASS_MEMORY + SIGNALS] == 1.0
    if began:
        smooth(lowpass, measurement[THETA], p.lowpass_step)
    else:
        lowpass[0], lowpass[1], lowpass[2] = measurement[THETA], 0.0, measurement[THETA]
    if began and not isnan(measurement[EFFORT]):
        fuse(signals, measurement, p.kalman_step, p.half_count)
    else:
        signals[:THETA_DOT] = measurement[:THETA_DOT]
        signals[THETA_DOT:] = 0.0
    memory[LOWPASS_MEMORY + SIGNALS] = 1.0
    if p.kalman:
        estimate[:] = signals
    else:
        estimate[PHI], estimate[PHI_DOT] = measurement[PHI], measurement[PHI_DOT]
        estimate[THETA], estimate[THETA_DOT] = lowpass[0], lowpass[1]
        estimate[EFFORT] = nan
    if p.ideal:
        estimate[:EFFORT] = measurement[:EFFORT]
