"""First estimate of the model: the paper's least squares with momenta instead of accelerations."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_identification.regression.equations import arm_equation, pendulum_equation
from furuta_identification.regression.windows import Windows
from furuta_recordings.recording import Recording


class MomentumFit(NamedTuple):
    """Coefficients by regression, and the standard error of α."""

    alpha: float
    beta: float
    gamma: float
    delta: float
    viscous: float
    coulomb: float
    coulomb_asymmetry: float
    pendulum_viscous: float
    pendulum_coulomb: float
    alpha_error: float


def momentum_fit(recording: Recording) -> MomentumFit:
    """Fit a recording that has all speeds, with θ = 0 upright."""
    windows = Windows(recording.time)
    pendulum = pendulum_equation(recording, windows).coefficients
    arm, arm_errors, _ = arm_equation(recording, windows, *pendulum[:2])
    alpha, delta, viscous, forward, backward = arm
    one_way = not np.all(np.isfinite(arm_errors[3:]))
    coulomb = forward + backward if one_way else 0.5 * (forward + backward)
    asymmetry = 0.0 if one_way or coulomb == 0.0 else 0.5 * (forward - backward) / coulomb
    beta, gamma, joint_viscous, joint_coulomb = pendulum[:4] * delta
    error = arm_errors[0]
    return MomentumFit(
        alpha, beta, gamma, delta, viscous, coulomb, asymmetry, joint_viscous, joint_coulomb, error
    )
