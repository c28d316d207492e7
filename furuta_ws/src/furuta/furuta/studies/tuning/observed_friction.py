r"""Fit of LuGre's parameters to the friction that the estimator observes in a limit cycle.

The estimator computes the friction from applied torque and motion, delayed by its own dynamics.
These are known: with e the error of (φ̇, θ, θ̇, F) and M the error transition matrix of the filter,

.. math::
    e_k = M e_{k-1} + (0, 0, 0, F_k - F_{k-1})

so any set of parameters determines the friction, the true speed and the friction that the estimator
would observe. The fit minimises the difference between this prediction and the observation. The
reversals of the arm determine the bristle parameters, its slides the friction level of each
direction. A few periods of the limit cycle without compensation are enough.

Parameters that the data hardly determine (α₁ and vs individually) are kept near the start by a weak
prior.
"""

from collections.abc import Callable
from math import atanh, exp, log, tanh
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from furuta_model.compiled import compiled
from furuta_model.friction.lugre import bristle_after, friction
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError
from furuta_model.state import OBSERVED_FRICTION, PHI_DOT, RIGID_STATES

# Standard deviation of the observed friction that the model cannot explain [V].
OBSERVATION_NOISE = 0.015
# Every n-th sample is used; the errors of closer samples depend on each other.
SAMPLE_STRIDE = 5
# Samples until the unknown initial deflection of the bristle has no effect any more.
TRANSIENT_SAMPLES = 500
SMALLEST = 1e-4


class Transform(NamedTuple):
    """Maps a parameter to an unbounded variable; ``prior_deviation`` is that variable's prior."""

    to_variable: Callable[[float], float]
    to_parameter: Callable[[float], float]
    prior_deviation: float


def _logarithm(value: float) -> float:
    return log(max(value, SMALLEST))


def _inverse_tanh(value: float) -> float:
    return atanh(min(max(value, SMALLEST - 1.0), 1.0 - SMALLEST))


def _identity(value: float) -> float:
    return value


TRANSFORMS = {
    "sigma0": Transform(_logarithm, exp, 1.0),
    "sigma1": Transform(_logarithm, exp, 1.0),
    "alpha0": Transform(_logarithm, exp, 1.0),
    "alpha1": Transform(_logarithm, exp, 0.5),
    "stribeck_velocity": Transform(_logarithm, exp, 0.3),
    "viscous": Transform(_identity, abs, 0.05),
    "asymmetry": Transform(_inverse_tanh, tanh, 1.0),
}
# Bounds of the fit around the start, in deviations of the prior.
BOUND = 4.0


def fit_friction(
    estimates: np.ndarray, kalman_step: np.ndarray, sample_time: float, start: Friction
) -> Friction:
    """Fit the parameters to ``estimates`` (n, 5), from the values ``start``.

    ``kalman_step`` is the filter's (:func:`furuta_control.estimators.kalman.sample_kalman`). Raises
    :class:`ParameterError` if the arm hardly moved or no friction was observed.
    """
    speed, observed = np.ascontiguousarray(estimates[:, PHI_DOT]), estimates[:, OBSERVED_FRICTION]
    _require_friction(speed, observed)
    errors = np.ascontiguousarray(kalman_step[1:, 1 : 1 + RIGID_STATES])
    pairs = TRANSFORMS.items()
    initial = np.array([kind.to_variable(getattr(start, name)) for name, kind in pairs])
    prior = np.array([kind.prior_deviation for kind in TRANSFORMS.values()])

    def residuals(variables: np.ndarray) -> np.ndarray:
        predicted = _predict_observed(speed, sample_time, _friction(variables, start), errors)
        used = (predicted - observed)[TRANSIENT_SAMPLES::SAMPLE_STRIDE]
        return np.append(used / OBSERVATION_NOISE, (variables - initial) / prior)

    bounds = (initial - BOUND * prior, initial + BOUND * prior)
    return _friction(least_squares(residuals, initial, bounds=bounds).x, start)


def _friction(variables: np.ndarray, start: Friction) -> Friction:
    """The friction parameters that belong to ``variables``."""
    pairs = zip(TRANSFORMS.items(), variables, strict=True)
    return start._replace(**{name: kind.to_parameter(float(x)) for (name, kind), x in pairs})


def _require_friction(speed: np.ndarray, observed: np.ndarray) -> None:
    if np.any(np.isnan(observed)):
        raise ParameterError("the estimator observes no friction")
    if len(speed) < 4 * TRANSIENT_SAMPLES or np.ptp(observed) < 4 * OBSERVATION_NOISE:
        raise ParameterError("the arm hardly moved, so there is no friction to observe")


@compiled
def _predict_observed(speed: np.ndarray, dt: float, p: Friction, errors: np.ndarray) -> np.ndarray:
    """The friction (n,) [V] that the estimator observes if the true one has parameters ``p``."""
    observed = np.empty(len(speed))
    e = np.zeros(4)
    z, previous = 0.0, 0.0
    for k in range(len(speed)):
        e = errors @ e
        v = speed[k] + e[0]
        z, _ = bristle_after(v, 0.0, z, dt, p)
        force = friction(v, z, p)
        e[3] += force - previous
        previous = force
        observed[k] = force - e[3]
    return observed
