"""State estimate from the sensors, by the paper's filter or a Kalman filter.

Measurement and estimate are (5,): x, then the applied torque and the estimated friction [V].
"""

from __future__ import annotations

from functools import lru_cache
from math import isnan, nan
from typing import NamedTuple

import numpy as np

from furuta_control.kalman import fuse, half_count, sample_kalman
from furuta_control.lowpass import MEMORY as LOWPASS_MEMORY
from furuta_control.lowpass import sample_lowpass, smooth
from furuta_control.parameters import EstimatorParameters
from furuta_model.compiled import inlined
from furuta_model.state import EFFORT, PHI, PHI_DOT, SIGNALS, THETA, THETA_DOT

# The estimator's memory: the Kalman filter's signals, that of the low-pass, whether it began.
LOWPASS = SIGNALS
BEGAN = LOWPASS + LOWPASS_MEMORY
MEMORY = BEGAN + 1


class EstimatorDesign(NamedTuple):
    """What :func:`estimate_state` computes with."""

    kalman: bool
    ideal: bool
    lowpass_step: np.ndarray
    kalman_step: np.ndarray
    half_count: float


@lru_cache(maxsize=64)
def design_estimator(p: EstimatorParameters) -> EstimatorDesign:
    """The estimator that the parameters describe; kept, for its design takes a millisecond."""
    return EstimatorDesign(
        p.method == "kalman",
        p.sensors.ideal,
        sample_lowpass(p),
        sample_kalman(p),
        half_count(p.sensors),
    )


@inlined
def estimate_state(
    memory: np.ndarray, measurement: np.ndarray, p: EstimatorDesign, estimate: np.ndarray
) -> None:
    """One sample: ``memory`` is updated, ``estimate`` (5,) written.

    Both filters run, so that a change of method finds the other in step. Without an applied
    torque (NaN) the Kalman filter has no past: it begins anew at every sample. Of what is measured
    exactly nothing is filtered, but for the friction that the Kalman filter finds.
    """
    if p.ideal and not p.kalman:
        for i in range(EFFORT):
            estimate[i] = measurement[i]
        estimate[EFFORT] = nan
        memory[BEGAN] = 0.0
        return
    theta = measurement[THETA]
    began = memory[BEGAN] == 1.0
    memory[BEGAN] = 1.0
    if began:
        smooth(memory, LOWPASS, theta, p.lowpass_step)
    else:
        memory[LOWPASS], memory[LOWPASS + 1], memory[LOWPASS + 2] = theta, 0.0, theta
    if began and not isnan(measurement[EFFORT]):
        fuse(memory, measurement, p.kalman_step, p.half_count)
    else:
        for i in range(THETA_DOT):
            memory[i] = measurement[i]
        memory[THETA_DOT] = memory[EFFORT] = 0.0
    if p.kalman:
        for i in range(SIGNALS):
            estimate[i] = memory[i]
    else:
        estimate[PHI], estimate[PHI_DOT] = measurement[PHI], measurement[PHI_DOT]
        estimate[THETA], estimate[THETA_DOT] = memory[LOWPASS], memory[LOWPASS + 1]
        estimate[EFFORT] = nan
    if p.ideal:
        for i in range(EFFORT):
            estimate[i] = measurement[i]
