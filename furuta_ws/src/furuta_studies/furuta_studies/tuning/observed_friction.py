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

from __future__ import annotations

from collections.abc import Callable
from math import atanh, exp, log, tanh
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from furuta_model.compiled import compiled
from furuta_model.lugre import LuGre, bristle_after, friction
from furuta_model.state import EFFORT, PHI_DOT

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


def _identity(value: float) -> float:
    return value


TRANSFORMS = {
    "sigma0": Transform(_logarithm, exp, 1.0),
    "sigma1": Transform(_logarithm, exp, 1.0),
    "alpha0": Transform(_logarithm, exp, 1.0),
    "alpha1": Transform(_logarithm, exp, 0.5),
    "stribeck_velocity": Transform(_logarithm, exp, 0.3),
    "viscous": Transform(_identity, abs, 0.05),
    "asymmetry": Transform(atanh, tanh, 1.0),
}
FITTED = tuple(TRANSFORMS)
# Bounds of the fit around the start, in deviations of the prior.
BOUND = 4.0


class FrictionFit(NamedTuple):
    """Fitted parameters, their standard errors by name, and the rms residual [V]."""

    friction: LuGre
    standard_errors: dict[str, float]
    residual: float


def fit_friction(
    estimates: np.ndarray,
    kalman_step: np.ndarray,
    sample_time: float,
    start: LuGre,
    names: tuple[str, ...] = FITTED,
) -> FrictionFit:
    """Fit the parameters ``names`` to ``estimates`` (n, 5); the others keep their start values.

    ``kalman_step`` is the filter's (:func:`furuta_control.kalman.sample_kalman`). Raises
    :class:`ValueError` if the arm hardly moved or no friction was observed.
    """
    speed, observed = np.ascontiguousarray(estimates[:, PHI_DOT]), estimates[:, EFFORT]
    _require_friction(speed, observed)
    errors = np.ascontiguousarray(kalman_step[1:, 1 : 1 + EFFORT])
    transforms = [TRANSFORMS[name] for name in names]
    pairs = zip(names, transforms, strict=True)
    initial = np.array([each.to_variable(getattr(start, name)) for name, each in pairs])
    prior = np.array([each.prior_deviation for each in transforms])

    def to_friction(variables: np.ndarray) -> LuGre:
        pairs = zip(transforms, variables, strict=True)
        fitted = (each.to_parameter(float(variable)) for each, variable in pairs)
        return start._replace(**dict(zip(names, fitted, strict=True)))

    def residuals(variables: np.ndarray) -> np.ndarray:
        predicted = _predict_observed(speed, sample_time, to_friction(variables), errors)
        return (predicted - observed)[TRANSIENT_SAMPLES::SAMPLE_STRIDE]

    solution = least_squares(
        lambda x: np.append(residuals(x) / OBSERVATION_NOISE, (x - initial) / prior),
        initial,
        bounds=(initial - BOUND * prior, initial + BOUND * prior),
    )
    deviation = np.sqrt(np.diag(np.linalg.inv(solution.jac.T @ solution.jac)))
    return FrictionFit(
        to_friction(solution.x),
        {
            name: _propagated_error(transform, variable, error)
            for name, transform, variable, error in zip(
                names, transforms, solution.x, deviation, strict=True
            )
        },
        float(np.sqrt(np.mean(residuals(solution.x) ** 2))),
    )


def _require_friction(speed: np.ndarray, observed: np.ndarray) -> None:
    if np.any(np.isnan(observed)):
        raise ValueError("the estimator observes no friction")
    if len(speed) < 4 * TRANSIENT_SAMPLES or np.ptp(observed) < 4 * OBSERVATION_NOISE:
        raise ValueError("the arm hardly moved, so there is no friction to observe")


def _propagated_error(transform: Transform, variable: float, error: float) -> float:
    """Standard error of the parameter from that of its variable, to first order."""
    step = 1e-6
    high, low = transform.to_parameter(variable + step), transform.to_parameter(variable - step)
    return abs(high - low) / (2 * step) * error


@compiled
def _predict_observed(speed: np.ndarray, dt: float, p: LuGre, errors: np.ndarray) -> np.ndarray:
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
