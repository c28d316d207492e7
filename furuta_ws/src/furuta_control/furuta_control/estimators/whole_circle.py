r"""Extended Kalman filter for the whole circle, with the gain scheduled by cos θ.

The prediction is eq. (1) itself over one sample, by the midpoint rule, which is stable up to a
viscous friction of :func:`largest_viscous`. Viscous friction is part of the model; the rest of the
friction is a random walk. The gain is that of the stationary Kalman filter
(:mod:`furuta_control.estimators.kalman`), designed once about upright and once about hanging:

.. math::
    K(θ) = \tfrac12 (1 + \cosθ) K_{upright} + \tfrac12 (1 - \cosθ) K_{hanging}

Upright and hanging this is the stationary filter of the linear model. Between them the coupling of
the joints, on which the entries of K between arm and pendulum depend, is proportional to cos θ as
well. The arm angle is treated as there: integrated, and kept within half a count of the encoder.
"""

from typing import NamedTuple

import numpy as np

from furuta_control.estimators import kalman
from furuta_control.estimators.method import NominalRig
from furuta_model.compiled import inlined
from furuta_model.elementary import sin_cos
from furuta_model.linear import KalmanParameters
from furuta_model.pendulum import FurutaPendulum, accelerations
from furuta_model.state import (
    APPLIED_TORQUE,
    OBSERVED_FRICTION,
    PHI,
    PHI_DOT,
    THETA,
    THETA_DOT,
)

# Corrected states: φ̇, θ, θ̇, F. Columns of a gain: tachometer, pendulum's sensor.
CORRECTED = 4
SENSORS = 2


class WholeCircle(NamedTuple):
    """The sampled filter: nominal model, gains (4, 2), sample time [s], half a count [rad]."""

    viscous: float
    model: FurutaPendulum
    upright: np.ndarray
    hanging: np.ndarray
    sample_time: float
    half_count: float


def design(rig: NominalRig, noise: KalmanParameters, is_chosen: bool) -> WholeCircle:
    """The filter for the nominal rig, with the process noise of the Kalman filter.

    If another method is chosen it has no gain, and takes no time to design.
    """
    upright = opposite = np.zeros((CORRECTED, SENSORS))
    if is_chosen:
        upright = kalman.stationary_gain(rig, noise)
        opposite = kalman.stationary_gain(rig._replace(model=hanging(rig.model)), noise)
    return WholeCircle(
        viscous=rig.viscous,
        model=rig.model,
        upright=upright,
        hanging=opposite,
        sample_time=rig.sample_time,
        half_count=kalman.half_count(rig.sensors),
    )


def largest_viscous(rig: NominalRig) -> float:
    """Viscous friction [V s/rad] up to which the midpoint rule is stable for the free arm."""
    return 2.0 * rig.model.determinant / rig.model.beta / rig.sample_time


def hanging(p: FurutaPendulum) -> FurutaPendulum:
    """The model whose linear model about upright is that of ``p`` about hanging: cos θ is −1."""
    return p._replace(gamma=-p.gamma, delta=-p.delta)


@inlined
def update(x: np.ndarray, measurement: np.ndarray, p: WholeCircle) -> None:
    """Move the estimate ``x`` by one sample with a ``measurement`` (5,)."""
    v, theta, w = x[PHI_DOT], x[THETA], x[THETA_DOT]
    torque, h = measurement[APPLIED_TORQUE] - x[OBSERVED_FRICTION], p.sample_time
    half = 0.5 * h
    v_dot, w_dot = accelerations(v, theta, w, torque - p.viscous * v, p.model)
    v_mid, w_mid = v + half * v_dot, w + half * w_dot
    left = torque - p.viscous * v_mid
    v_dot, w_dot = accelerations(v_mid, theta + half * w, w_mid, left, p.model)
    x[PHI] += h * v_mid
    x[PHI_DOT], x[THETA] = v + h * v_dot, theta + h * w_mid
    x[THETA_DOT] = w + h * w_dot
    _correct(x, measurement, p)
    x[PHI] = kalman.within_count(x[PHI], measurement[PHI], p.half_count)


@inlined
def _correct(x: np.ndarray, measurement: np.ndarray, p: WholeCircle) -> None:
    """Correct the prediction ``x`` (5,) by the readings of arm speed and pendulum angle."""
    speed = measurement[PHI_DOT] - x[PHI_DOT]
    angle = measurement[THETA] - x[THETA]
    _, cosine = sin_cos(x[THETA])
    share = 0.5 + 0.5 * cosine
    for i in range(CORRECTED):
        of_speed = p.hanging[i, 0] + share * (p.upright[i, 0] - p.hanging[i, 0])
        of_angle = p.hanging[i, 1] + share * (p.upright[i, 1] - p.hanging[i, 1])
        x[PHI_DOT + i] += of_speed * speed + of_angle * angle
