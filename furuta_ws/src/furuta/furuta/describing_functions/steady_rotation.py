r"""Steady rotations, for Nyquist curves that start on the negative real axis, Fig. 4 c, d.

If l₁ = 0, G(0) = −1/l₂. A solution of 1 + G(0)N = 0 at ω = 0 is not an oscillation: a constant
speed v has N = F/v, so l₂v = F. The positive feedback of the arm speed then cancels friction
exactly, with the pendulum upright:

.. math::
    l_2v = g(v) + σ_2v

with g(v) the sliding level. (l₂ − σ₂)v rises with v and g falls, so there is one such speed in each
direction if l₂ > σ₂, otherwise none. The friction of the sliding arm is nearly constant, so the
rotation is about as stable as the loop without friction. The characteristic polynomial here also
includes the slope of g, the lag of the bristle and the centrifugal torque, which replaces δ by
δ + βv². Nothing is neglected.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from furuta.describing_functions.levels import level_slope
from furuta.transfer import checked_feedback, transfer
from furuta_model.friction.laws import FrictionLaw, sliding_level
from furuta_model.pendulum import FurutaPendulum


class Rotation(NamedTuple):
    """Steady rotation of the arm with the pendulum upright: φ̇ [rad/s], and if it is stable."""

    rate_rad_s: float
    stable: bool


def steady_rotations(
    p: FurutaPendulum, feedback: Sequence[float], law: FrictionLaw
) -> tuple[Rotation, ...]:
    """The rotation in each direction; none if l₁ ≠ 0 or l₂ ≤ σ₂."""
    l1, l2, _, _ = checked_feedback(feedback)
    if l1 != 0.0 or l2 <= law.parameters.viscous:
        return ()
    return tuple(
        Rotation(direction * speed, rotation_growth(direction * speed, p, feedback, law) < 0.0)
        for direction in (1.0, -1.0)
        if (speed := _speed(direction, l2 - law.parameters.viscous, law)) > 0.0
    )


def _speed(direction: float, excess: float, law: FrictionLaw) -> float:
    """|v| [rad/s] with ``excess`` |v| = g(v), bracketed by the levels at rest and at high speed."""
    low = sliding_level(np.inf, direction, law) / excess
    high = sliding_level(0.0, direction, law) / excess
    if high <= low:
        return low

    from scipy.optimize import brentq

    def surplus(speed: float) -> float:
        return excess * speed - sliding_level(speed, direction, law)

    return float(brentq(surplus, low, high, xtol=1e-15 * high))


def rotation_growth(
    v: float,
    p: FurutaPendulum,
    feedback: Sequence[float],
    law: FrictionLaw,
    linear: bool = False,
) -> float:
    """Growth rate [1/s] of the fastest disturbance of the steady rotation at v [rad/s].

    A ``linear`` pendulum has no centrifugal torque.
    """
    delta = p.delta if linear else p.delta + p.beta * v * v
    g = transfer(p._replace(delta=delta), feedback)
    numerator, denominator = g.cancelled
    friction_numerator, friction_denominator = _friction_about(v, law)
    characteristic = np.polyadd(
        np.polymul(denominator, friction_denominator), np.polymul(numerator, friction_numerator)
    )
    return float(np.max(np.roots(characteristic).real))


def _friction_about(v: float, law: FrictionLaw) -> tuple[np.ndarray, np.ndarray]:
    """δF/δv about steady sliding at v as a transfer function: numerator, denominator.

    For LuGre, with λ = σ₀|v|/g, it is (σ₀ + σ₁s)(λ/σ₀) g'/(s + λ) + σ₂: the slope of g, delayed by
    the lag of the bristle.
    """
    p = law.parameters
    slope = _level_slope(v, law)
    if not law.bristle:
        return np.array([slope + p.viscous]), np.array([1.0])
    rate = p.sigma0 * abs(v) / sliding_level(v, float(np.sign(v)), law)
    lag = np.array([1.0, rate])
    return np.polyadd(
        slope * rate / p.sigma0 * np.array([p.sigma1, p.sigma0]), p.viscous * lag
    ), lag


def _level_slope(v: float, law: FrictionLaw) -> float:
    """dF/dv [V s/rad] of the sliding arm without viscous part; at most 0."""
    p = law.parameters
    return float(level_slope(abs(v), law.law, p) * (1.0 + np.sign(v) * p.asymmetry))
