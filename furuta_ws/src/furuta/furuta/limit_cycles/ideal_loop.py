r"""Equations of the ideal loop: all states measured, u = l·x without sampling or saturation.

The motion consists of smooth pieces. The arm slides in one direction (``mode`` ±1) or, under a
stick-slip law, sticks (``mode`` 0) while the pendulum moves with β θ̈ = δ sin θ. A slide ends at
v = 0. Sticking ends when the friction that holds the arm,

.. math::
    F_{hold} = u - γ\cosθ\,\frac{δ}{β}\sinθ + γ\sinθ\,\dot θ^2,

reaches the breakaway level. Under LuGre the arm never sticks; its slides end at v = 0, where |v| is
not smooth.

Near a rest the state is counted from that rest (:func:`rest_near`), so that a motion which
passes it at 1e-10 is not lost in the rounding of φ and of the deflection.
"""

from __future__ import annotations

from math import cos, sin, sqrt
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled
from furuta_model.friction.bristle import deflection_rate
from furuta_model.friction.laws import FrictionLaw, breakaway_level, has_bristle, sliding_level
from furuta_model.friction.lugre import highest_level
from furuta_model.pendulum import FurutaPendulum, accelerations
from furuta_model.state import BRISTLE, PHI, PHI_DOT, THETA, THETA_DOT


class IdealLoop(NamedTuple):
    """Pendulum (nonlinear, or linear about upright), friction law and feedback u = l·x.

    ``l1``, ``l3`` [V/rad] and ``l2``, ``l4`` [V s/rad] feed back φ, θ, φ̇ and θ̇. ``held`` is the
    friction [V] of the rest from which φ and the deflection are counted.
    """

    body: FurutaPendulum
    law: FrictionLaw
    l1: float
    l2: float
    l3: float
    l4: float
    linear: bool = False
    held: float = 0.0

    @property
    def gains(self) -> tuple[float, float, float, float]:
        """Feedback gains l of u = l·x [V per unit of state]."""
        return self.l1, self.l2, self.l3, self.l4

    def with_gains(self, gains: tuple[float, float, float, float]) -> IdealLoop:
        """The same loop with other feedback gains."""
        l1, l2, l3, l4 = gains
        return self._replace(l1=l1, l2=l2, l3=l3, l4=l4)


@compiled
def feedback(y: np.ndarray, loop: IdealLoop) -> float:
    """Control u = l·x [V]."""
    return loop.l1 * y[PHI] + loop.l2 * y[PHI_DOT] + loop.l3 * y[THETA] + loop.l4 * y[THETA_DOT]


@compiled
def body_accelerations(y: np.ndarray, torque: float, loop: IdealLoop) -> tuple[float, float]:
    """(φ̈, θ̈) [rad/s²] of the nonlinear or linear body under torque u − F [V]."""
    p = loop.body
    if not loop.linear:
        return accelerations(y[PHI_DOT], y[THETA], y[THETA_DOT], torque, p)
    d = p.alpha * p.beta - p.gamma * p.gamma
    gravity = p.delta * y[THETA]
    return (p.beta * torque - p.gamma * gravity) / d, (p.alpha * gravity - p.gamma * torque) / d


@compiled
def holding_force(y: np.ndarray, loop: IdealLoop) -> float:
    """Friction [V] that holds the arm at rest, counted from ``held``."""
    p = loop.body
    theta, w = y[THETA], y[THETA_DOT]
    if loop.linear:
        return feedback(y, loop) - p.gamma * p.delta / p.beta * theta
    pull = p.gamma * cos(theta) * p.delta / p.beta * sin(theta) - p.gamma * sin(theta) * w * w
    return feedback(y, loop) - pull


@compiled
def rate(y: np.ndarray, mode: float, loop: IdealLoop, dy: np.ndarray) -> None:
    """Compute ẏ (5,) while the arm slides in direction ``mode`` (±1) or sticks (0)."""
    p = loop.law.parameters
    v = y[PHI_DOT]
    dy[PHI], dy[THETA], dy[BRISTLE] = v, y[THETA_DOT], 0.0
    if mode == 0.0:
        sine = y[THETA] if loop.linear else sin(y[THETA])
        dy[PHI], dy[PHI_DOT] = 0.0, 0.0
        dy[THETA_DOT] = loop.body.delta / loop.body.beta * sine
        return
    level = sliding_level(v, mode, loop.law)
    if has_bristle(loop.law):
        z = y[BRISTLE]
        dy[BRISTLE] = deflection_rate(v, mode * v, z + loop.held / p.sigma0, level, p)
        force = p.sigma0 * z + p.sigma1 * dy[BRISTLE]
    else:
        force = mode * level - loop.held
    torque = feedback(y, loop) - force - p.viscous * v
    dy[PHI_DOT], dy[THETA_DOT] = body_accelerations(y, torque, loop)


@compiled
def friction_at(y: np.ndarray, loop: IdealLoop) -> float:
    """Friction [V] in state ``y`` (5,), while the arm slides or sticks."""
    p = loop.law.parameters
    v = y[PHI_DOT]
    if v == 0.0 and not has_bristle(loop.law):
        return holding_force(y, loop)
    mode = 1.0 if v >= 0.0 else -1.0
    level = sliding_level(v, mode, loop.law)
    if has_bristle(loop.law):
        z = y[BRISTLE]
        z_dot = deflection_rate(v, abs(v), z, level, p)
        return p.sigma0 * z + p.sigma1 * z_dot + p.viscous * v
    return mode * level + p.viscous * v


@compiled
def before_event(y: np.ndarray, mode: float, loop: IdealLoop) -> float:
    """Event function: positive during the piece of motion ``mode``, zero at its end."""
    if mode != 0.0:
        return mode * y[PHI_DOT]
    hold = holding_force(y, loop)
    forward = breakaway_level(1.0, loop.law) - loop.held
    backward = breakaway_level(-1.0, loop.law) + loop.held
    return min(forward - hold, backward + hold)


@compiled
def next_mode(y: np.ndarray, mode: float, loop: IdealLoop) -> float:
    """Mode of the piece of motion that follows an event at ``y``."""
    if has_bristle(loop.law):
        return -mode
    hold = holding_force(y, loop)
    if mode != 0.0 and -breakaway_level(-1.0, loop.law) <= hold <= breakaway_level(1.0, loop.law):
        return 0.0
    return 1.0 if hold > 0.0 else -1.0


@compiled
def smallest_slide(loop: IdealLoop) -> float:
    """Smallest motion [rad] that is a slide: the full deflection of a bristle, both ways."""
    if not has_bristle(loop.law):
        return 0.0
    return 2.0 * highest_level(loop.law.parameters) / loop.law.parameters.sigma0


@compiled
def rest_distance(y: np.ndarray, mode: float, loop: IdealLoop) -> float:
    """Distance of ``y`` from the rest that it approaches in the piece of motion ``mode``.

    Root of the sum of squares of v, θ, θ̇ [rad, rad/s] and of the torque on the arm [V]; a stuck
    arm has no torque.
    """
    torque = loop.l1 * y[PHI]
    if mode == 0.0:
        torque = 0.0
    elif has_bristle(loop.law):
        torque -= loop.law.parameters.sigma0 * y[BRISTLE]
    else:
        torque -= mode * sliding_level(0.0, mode, loop.law) - loop.held
    v, theta, w = y[PHI_DOT], y[THETA], y[THETA_DOT]
    return sqrt(v * v + theta * theta + w * w + torque * torque)


@compiled
def rest_near(y: np.ndarray, mode: float, loop: IdealLoop) -> tuple[float, float]:
    """Arm angle [rad] and friction [V] of the rest near ``y``, which was reached in ``mode``."""
    if mode == 0.0:
        return y[PHI], loop.l1 * y[PHI]
    if loop.l1 == 0.0:
        return y[PHI], 0.0
    if has_bristle(loop.law):
        held = loop.law.parameters.sigma0 * y[BRISTLE]
    else:
        held = mode * sliding_level(0.0, mode, loop.law)
    return held / loop.l1, held
