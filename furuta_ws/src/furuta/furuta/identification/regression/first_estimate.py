"""The first estimate of a model: the paper's least squares with momenta instead of accelerations.

The delay of the command and its sign are searched together with the coefficients.
"""

from typing import NamedTuple

import numpy as np

from furuta.identification.regression.equations import (
    arm_equation,
    arm_misfits,
    pendulum_equation,
)
from furuta.identification.regression.speeds import with_speeds
from furuta.identification.regression.windows import Windows
from furuta_model.parameters import ParameterError
from furuta_recordings.recording import Recording

# Delays [s] to search, and how much larger than the smallest the misfit may be.
LONGEST_DELAY, DELAY_STEP = 0.15, 0.01
LARGEST_MISFIT_RATIO = 1.5


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


class FirstEstimate(NamedTuple):
    """The recordings, with negated commands if ``negated``; regression; delay [s].

    A negative delay is that of a log in which commands are later than they act.
    """

    recordings: list[Recording]
    regression: MomentumFit
    delay: float
    negated: bool


def first_estimate(recordings: list[Recording], lag: float) -> FirstEstimate:
    """Find the shortest delay with an almost minimal misfit and a possible pendulum.

    Not the delay with the smallest misfit: in slow motion a delay resembles an inertia.
    """
    for delay in _delays(recordings, lag):
        for negated in (False, True):
            candidates = [r.with_command_negated() if negated else r for r in recordings]
            best = _most_certain(candidates, lag, delay)
            if min(best.alpha, best.beta, best.gamma, best.delta) > 0.0:
                return FirstEstimate(candidates, best, delay, negated)
    raise ParameterError(
        f"{', '.join(r.name for r in recordings)}: this is not the motion of a Furuta "
        "pendulum under this command (the regression finds a negative inertia); check joints and "
        "command, and record a motion in which the arm accelerates and brakes"
    )


def _delays(recordings: list[Recording], lag: float) -> list[float]:
    """Delays [s] with an almost minimal misfit, the shortest first."""
    delays = np.arange(-LONGEST_DELAY, LONGEST_DELAY + 1e-9, DELAY_STEP)
    misfits = [arm_misfits(with_speeds(r, lag), delays) for r in recordings]
    total = np.sqrt(np.sum(np.square(misfits), axis=0))
    good = delays[total <= LARGEST_MISFIT_RATIO * np.min(total)]
    return [float(delay) for delay in good[np.argsort(np.abs(good), kind="stable")]]


def _most_certain(recordings: list[Recording], lag: float, delay: float) -> MomentumFit:
    """The regression with the smallest relative error of α."""
    fits = [momentum_fit(with_speeds(r.with_delayed_command(delay), lag)) for r in recordings]
    return min(fits, key=lambda fit: abs(fit.alpha_error / fit.alpha))


def momentum_fit(recording: Recording) -> MomentumFit:
    """Fit a recording that has all speeds, with θ = 0 upright."""
    windows = Windows(recording.time)
    pendulum = pendulum_equation(recording, windows).coefficients
    arm = arm_equation(recording, windows, *pendulum[:2])
    alpha, delta, viscous, forward, backward = arm.coefficients
    one_way = not np.all(np.isfinite(arm.errors[3:]))
    coulomb = forward + backward if one_way else 0.5 * (forward + backward)
    asymmetry = 0.0 if one_way or coulomb == 0.0 else 0.5 * (forward - backward) / coulomb
    beta, gamma, joint_viscous, joint_coulomb = pendulum[:4] * delta
    body, of_arm = (alpha, beta, gamma, delta), (viscous, coulomb, asymmetry)
    return MomentumFit(*body, *of_arm, joint_viscous, joint_coulomb, arm.errors[0])
