r"""Steady rotation: what a Nyquist curve means that starts on the negative real axis, Fig. 4 c, d.

Where l₁ = 0, G(0) = −1/l₂. A balance 1 + G(0)N = 0 at ω = 0 is no oscillation: a constant speed v
has N = F/v, so it says l₂v = F. The feedback of the arm's speed is positive and cancels friction
exactly, with the pendulum upright:

.. math::
    l_2v = g(v) + σ_2v

with g(v) the sliding level. The left side less the viscous part rises with v and g falls, so there
is one such speed in each direction where l₂ > σ₂, none otherwise. Sliding, friction is nearly
constant and drops out of the linearised equations: the rotation is as stable as the loop without
friction, but for the slope of g and the bristle's lag, both in the characteristic polynomial here,
and for the centrifugal torque, which turns δ into δ + βv² there. Nothing is neglected.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from furuta_analysis.describing_functions.transfer import checked_feedback, transfer
from furuta_model.friction.laws import FrictionLaw, sliding_level
from furuta_model.pendulum import FurutaPendulum


class Rotation(NamedTuple):
    """Steady rotation of the arm with the pendulum upright: φ̇ [rad/s], whether it is stable."""

    rate_rad_s: float
    stable: bool


def steady_rotations(
    p: FurutaPendulum, feedback: Sequence[float], law: FrictionLaw
) -> tuple[Rotation, ...]:
    """The rotation of each direction, none where l₁ ≠ 0 or l₂ ≤ σ₂."""
    l1, l2, _, _ = checked_feedback(feedback)
    if l1 != 0.0 or l2 <= law.parameters.viscous:
        return ()
    return tuple(
        Rotation(direction * speed, _stable(direction * speed, p, feedback, law))
        for direction in (1.0, -1.0)
        if (speed := _speed(direction, l2 - law.parameters.viscous, law)) > 0.0
    )


def _speed(direction: float, excess: float, law: FrictionLaw) -> float:
    """|v| [rad/s] of ``excess`` |v| = g(v), bracketed by the levels at rest and at high speed."""
    low = sliding_level(np.inf, direction, law) / excess
    high = sliding_level(0.0, direction, law) / excess
    if high <= low:
        return low

    def lacking(speed: float) -> float:
        return excess * speed - sliding_level(speed, direction, law)

    return float(brentq(lacking, low, high, xtol=1e-15 * high))


def _stable(v: float, p: FurutaPendulum, feedback: Sequence[float], law: FrictionLaw) -> bool:
    g = transfer(p._replace(delta=p.delta + p.beta * v * v), feedback)
    numerator, denominator = g.cancelled
    above, below = _friction_about(v, law)
    characteristic = np.polyadd(np.polymul(denominator, below), np.polymul(numerator, above))
    return bool(np.all(np.roots(characteristic).real < 0.0))


def _friction_about(v: float, law: FrictionLaw) -> tuple[np.ndarray, np.ndarray]:
    """δF/δv about steady sliding at v as a transfer function: numerator, denominator.

    For LuGre, with λ = σ₀|v|/g, it is (σ₀ + σ₁s)(λ/σ₀) g'/(s + λ) + σ₂: the slope of g through the
    bristle's lag.
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
    """d(friction)/dv [V s/rad] of the sliding arm, viscous part apart: at most 0."""
    p = law.parameters
    return float(law.law.level_slope(abs(v), p) * (1.0 + np.sign(v) * p.asymmetry))
