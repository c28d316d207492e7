r"""LuGre's parameters from the friction that the estimator sees in a limit cycle.

The estimator finds the friction between applied torque and motion, late by its own dynamics. They
are known: with e the error of (φ̇, θ, θ̇, F) and M the filter's error transition,

.. math::
    e_k = M e_{k-1} + (0, 0, 0, F_k - F_{k-1})

so for any parameters the friction, the speed that belongs to it and what the estimator would have
seen follow together. The parameters are those whose prediction is nearest to what was seen. The
arm's reversals show the bristle, its slides the levels in each direction: a few turns of the limit
cycle without compensation suffice.

What the data hardly tell (α₁ and vs apart from each other) is held near the start by a weak prior.
"""

from __future__ import annotations

from collections.abc import Callable
from math import atanh, exp, log, tanh
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from furuta_model.compiled import compiled
from furuta_model.friction.lugre import bristle_after, friction
from furuta_model.friction.parameters import LuGre
from furuta_model.state import OBSERVED_FRICTION, PHI_DOT, RIGID_STATES

# Standard deviation [V] of a seen friction that the model cannot explain, and the samples between
# two whose errors do not depend on each other.
SEEN_NOISE = 0.015
APART = 5
# Samples until the bristle's unknown start is forgotten.
FORGOTTEN = 500
SMALLEST = 1e-4


class Scale(NamedTuple):
    """How a parameter is measured in the fit: a map to the line, and how far it may be off."""

    to_line: Callable[[float], float]
    from_line: Callable[[float], float]
    spread: float


def _logarithm(value: float) -> float:
    return log(max(value, SMALLEST))


def _same(value: float) -> float:
    return value


SCALES = {
    "sigma0": Scale(_logarithm, exp, 1.0),
    "sigma1": Scale(_logarithm, exp, 1.0),
    "alpha0": Scale(_logarithm, exp, 1.0),
    "alpha1": Scale(_logarithm, exp, 0.5),
    "stribeck_velocity": Scale(_logarithm, exp, 0.3),
    "viscous": Scale(_same, abs, 0.05),
    "asymmetry": Scale(atanh, tanh, 1.0),
}
# How far the line is searched, in spreads.
REACH = 4.0


class SeenFriction(NamedTuple):
    """Fitted parameters, their standard errors by name, and the misfit (rms) [V]."""

    friction: LuGre
    standard_errors: dict[str, float]
    misfit: float


def fit_friction(
    estimates: np.ndarray,
    kalman_step: np.ndarray,
    sample_time: float,
    start: LuGre,
    names: tuple[str, ...] = tuple(SCALES),
) -> SeenFriction:
    """Fit the parameters ``names`` to ``estimates`` (n, 5), the others staying as in ``start``.

    ``kalman_step`` is the filter's (:func:`furuta_control.kalman.sample_kalman`). Raises
    :class:`ValueError` where the arm hardly moved or no friction was seen.
    """
    speed, seen = np.ascontiguousarray(estimates[:, PHI_DOT]), estimates[:, OBSERVED_FRICTION]
    _check(speed, seen)
    errors = np.ascontiguousarray(kalman_step[1:, 1 : 1 + RIGID_STATES])
    scales = [SCALES[name] for name in names]
    begin = np.array([s.to_line(getattr(start, n)) for n, s in zip(names, scales, strict=True)])
    spread = np.array([s.spread for s in scales])

    def made(line: np.ndarray) -> LuGre:
        given = (s.from_line(float(each)) for s, each in zip(scales, line, strict=True))
        return start._replace(**dict(zip(names, given, strict=True)))

    def misfit(line: np.ndarray) -> np.ndarray:
        difference = _predict(speed, sample_time, made(line), errors) - seen
        return difference[FORGOTTEN::APART]

    found = least_squares(
        lambda line: np.append(misfit(line) / SEEN_NOISE, (line - begin) / spread),
        begin,
        bounds=(begin - REACH * spread, begin + REACH * spread),
    )
    deviation = np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac)))
    return SeenFriction(
        made(found.x),
        {
            name: _propagated(scale, each, error)
            for name, scale, each, error in zip(names, scales, found.x, deviation, strict=True)
        },
        float(np.sqrt(np.mean(misfit(found.x) ** 2))),
    )


def _check(speed: np.ndarray, seen: np.ndarray) -> None:
    if np.any(np.isnan(seen)):
        raise ValueError("the estimator sees no friction")
    if len(speed) < 4 * FORGOTTEN or np.ptp(seen) < 4 * SEEN_NOISE:
        raise ValueError("the arm hardly moved: there is no friction to be seen")


def _propagated(scale: Scale, line: float, error: float) -> float:
    """Standard error of the parameter from that on the line, to first order."""
    step = 1e-6
    return abs(scale.from_line(line + step) - scale.from_line(line - step)) / (2 * step) * error


@compiled
def _predict(speed: np.ndarray, dt: float, p: LuGre, errors: np.ndarray) -> np.ndarray:
    """The friction (n,) [V] that the estimator sees if the true one has parameters ``p``."""
    seen = np.empty(len(speed))
    e = np.zeros(4)
    z, before = 0.0, 0.0
    for k in range(len(speed)):
        e = errors @ e
        v = speed[k] + e[0]
        z, _ = bristle_after(v, 0.0, z, dt, p)
        force = friction(v, z, p)
        e[3] += force - before
        before = force
        seen[k] = force - e[3]
    return seen
