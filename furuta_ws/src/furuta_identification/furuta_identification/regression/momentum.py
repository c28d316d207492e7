"""First estimate of the model: the paper's least squares with momenta instead of accelerations."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_identification.regression.equations import arm_equation, pendulum_equation
from furuta_identification.regression.windows import Windows
from furuta_recordings.recording import Recording


class MomentumFit(NamedTuple):
    """Coefficients by regression; standard errors (9,) in the order of the first nine fields."""

    alpha: float
    beta: float
    gamma: float
    delta: float
    viscous: float
    coulomb: float
    coulomb_asymmetry: float
    pendulum_viscous: float
    pendulum_coulomb: float
    standard_errors: np.ndarray


def momentum_fit(recording: Recording) -> MomentumFit:
    """Fit a recording that has all speeds, with θ = 0 upright."""
    windows = Windows(recording.time)
    pendulum, pendulum_errors, _ = pendulum_equation(recording, windows)
    arm, arm_errors, _ = arm_equation(recording, windows, *pendulum[:2])
    alpha, delta, viscous, forward, backward = arm
    one_way = not np.all(np.isfinite(arm_errors[3:]))
    coulomb = forward + backward if one_way else 0.5 * (forward + backward)
    asymmetry = 0.0 if one_way or coulomb == 0.0 else 0.5 * (forward - backward) / coulomb
    beta, gamma, pendulum_viscous, pendulum_coulomb = pendulum[:4] * delta
    return MomentumFit(
        alpha,
        beta,
        gamma,
        delta,
        viscous,
        coulomb,
        asymmetry,
        pendulum_viscous,
        pendulum_coulomb,
        _standard_errors(pendulum, delta * pendulum_errors[:4], arm_errors, coulomb),
    )


def _standard_errors(
    pendulum: np.ndarray, pendulum_errors: np.ndarray, arm_errors: np.ndarray, coulomb: float
) -> np.ndarray:
    """Errors of β and γ combine those of their ratios to δ and that of δ."""
    level = np.hypot(arm_errors[3], arm_errors[4]) / 2
    return np.array(
        [
            arm_errors[0],
            np.hypot(pendulum_errors[0], pendulum[0] * arm_errors[1]),
            np.hypot(pendulum_errors[1], pendulum[1] * arm_errors[1]),
            arm_errors[1],
            arm_errors[2],
            level,
            level / max(abs(coulomb), 1e-12),
            pendulum_errors[2],
            pendulum_errors[3],
        ]
    )
