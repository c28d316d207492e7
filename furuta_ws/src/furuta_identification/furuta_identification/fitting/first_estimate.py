"""The first estimate of a model by regression: coefficients, delay and sign of the command."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_identification.regression.equations import arm_misfits
from furuta_identification.regression.momentum import MomentumFit, momentum_fit
from furuta_identification.regression.speeds import with_speeds
from furuta_identification.shooting.parameter_values import ParameterValues
from furuta_model.parameters import ParameterError
from furuta_recordings.recording import Recording

# Delays [s] to search, and how much larger than the smallest the misfit may be.
LONGEST_DELAY, DELAY_STEP = 0.15, 0.01
LARGEST_MISFIT_RATIO = 1.5


class FirstEstimate(NamedTuple):
    """The recordings, with negated commands if ``negated``; regression; delay [s]."""

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
        f"{', '.join(each.name for each in recordings)}: this is not the motion of a Furuta "
        "pendulum under this command (the regression finds a negative inertia); check joints and "
        "command, and record a motion in which the arm accelerates and brakes"
    )


def _delays(recordings: list[Recording], lag: float) -> list[float]:
    """Delays [s] with an almost minimal misfit, the shortest first."""
    delays = np.arange(-LONGEST_DELAY, LONGEST_DELAY + 1e-9, DELAY_STEP)
    misfits = [arm_misfits(with_speeds(each, lag), delays) for each in recordings]
    total = np.sqrt(np.sum(np.square(misfits), axis=0))
    good = delays[total <= LARGEST_MISFIT_RATIO * np.min(total)]
    return [float(delay) for delay in good[np.argsort(np.abs(good), kind="stable")]]


def _most_certain(recordings: list[Recording], lag: float, delay: float) -> MomentumFit:
    """The regression with the smallest relative error of α."""
    fits = [momentum_fit(with_speeds(each.with_delayed_command(delay), lag)) for each in recordings]
    return min(fits, key=lambda fit: abs(fit.alpha_error / fit.alpha))


def starting_values(fit: MomentumFit, lag: float, ceiling: float = np.inf) -> ParameterValues:
    """Values of the unknowns from a regression, moved into their ranges."""
    inertia = max(fit.alpha - fit.gamma**2 / fit.beta, 0.05 * fit.alpha)
    return ParameterValues.of(
        arm_inertia=inertia,
        beta=fit.beta,
        gamma=fit.gamma,
        delta=fit.delta,
        viscous=max(fit.viscous, 0.0),
        coulomb=max(fit.coulomb, 0.0),
        asymmetry=float(np.clip(fit.coulomb_asymmetry, -0.5, 0.5)),
        pendulum_viscous=max(fit.pendulum_viscous, 1e-6 * fit.beta),
        pendulum_coulomb=max(fit.pendulum_coulomb, 0.0),
        lag=lag,
        ceiling=ceiling,
    )
