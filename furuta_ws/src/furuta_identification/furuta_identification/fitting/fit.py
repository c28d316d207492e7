"""From recordings to a model: regression, then output error over ever longer stretches."""

from __future__ import annotations

import numpy as np

from furuta_identification.fitting.balanced import fit_balanced
from furuta_identification.fitting.model import Model
from furuta_identification.fitting.swinging import fit_swinging
from furuta_identification.preparation.pieces import pieces
from furuta_identification.preparation.preparation import Options, prepare
from furuta_identification.regression.momentum import MomentumFit, arm_misfits, momentum_fit
from furuta_identification.regression.speeds import speed_lag, with_speeds
from furuta_identification.shooting.unknowns import Guess
from furuta_model.parameters import ParameterError
from furuta_model.state import THETA
from furuta_recordings.recording import Recording

# Pendulum angle [rad] within which it was balanced, not swinging.
BALANCED = 0.7
# Delays [s] looked through, and how much worse than with the best one the regression may be.
LONGEST_DELAY = 0.15
AS_GOOD = 1.5


def identify(recordings: list[Recording], options: Options) -> Model:
    """Fit one model to all recordings; raises :class:`ParameterError` where that cannot be done."""
    findings: list[str] = []
    prepared = []
    for each in recordings:
        whole, found = pieces(each)
        findings += found
        for piece in whole:
            ready, found = prepare(piece, options)
            prepared.append(ready)
            findings += found
    lag = float(np.median([speed_lag(each) for each in prepared]))
    prepared, regression, delay, negated = _regress(prepared, lag)
    if negated:
        findings.append("a positive command turns the arm in its negative direction: sign inverted")
    guess = _first_guess(regression, lag)
    if all(np.max(np.abs(each.measured[:, THETA])) < BALANCED for each in prepared):
        # In so slow a motion the regression hardly tells a delay from an inertia.
        model, delay = fit_balanced(prepared, guess, regression, findings, options), 0.0
    else:
        later = [each.with_delayed_command(delay) for each in prepared]
        model = fit_swinging(later, guess, regression, findings, options)
    return model._replace(command_negated=negated, shift=delay)


def _regress(
    recordings: list[Recording], lag: float
) -> tuple[list[Recording], MomentumFit, float, bool]:
    """The recordings, their best regression, a delay [s], and whether the command was negated.

    The delay is the least with which the regression is about as good as can be and finds a
    pendulum, not the best one: in slow motion a delay is much like an inertia.
    """
    delays = np.arange(-LONGEST_DELAY, LONGEST_DELAY + 1e-9, 0.01)
    misfits = [arm_misfits(with_speeds(each, lag), delays) for each in recordings]
    total = np.sqrt(np.sum(np.square(misfits), axis=0))
    good = delays[total <= AS_GOOD * np.min(total)]
    for delay in good[np.argsort(np.abs(good), kind="stable")]:
        for negated in (False, True):
            each_turned = [each.with_command_negated() if negated else each for each in recordings]
            best = _surest(each_turned, lag, float(delay))
            if min(best.alpha, best.beta, best.gamma, best.delta) > 0.0:
                return each_turned, best, float(delay), negated
    raise ParameterError(
        f"{', '.join(each.name for each in recordings)}: no Furuta pendulum under this command "
        "moves so (the regression finds a negative inertia); are joints and command the right "
        "ones, and does the arm speed up and slow down in it?"
    )


def _surest(recordings: list[Recording], lag: float, delay: float) -> MomentumFit:
    fits = [momentum_fit(with_speeds(each.with_delayed_command(delay), lag)) for each in recordings]
    return min(fits, key=lambda fit: abs(fit.standard_errors[0] / fit.alpha))


def _first_guess(fit: MomentumFit, lag: float) -> Guess:
    inertia = max(fit.alpha - fit.gamma**2 / fit.beta, 0.05 * fit.alpha)
    return Guess.of(
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
    )
