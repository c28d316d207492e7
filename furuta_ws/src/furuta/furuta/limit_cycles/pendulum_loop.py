r"""The loop of the pendulum in ideal form: all states measured, u = l·x, no sampling or saturation.

While the arm sticks, the pendulum moves with β θ̈ = δ sin θ, and the friction that holds the arm is

.. math::
    F_{hold} = u - γ\cosθ\,\frac{δ}{β}\sinθ + γ\sinθ\,\dot θ^2.

Near a rest the state is counted from that rest (:func:`rest_near`), so that a motion which
passes it at 1e-10 is not lost in the rounding of φ and of the deflection.
"""

from __future__ import annotations

from math import cos, sin, sqrt
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled
from furuta_model.friction.laws import FrictionLaw, check_friction, sliding_level
from furuta_model.parameters import ParameterError, validated
from furuta_model.pendulum import FurutaPendulum, accelerations
from furuta_model.state import BRISTLE, HORIZONTAL, PHI, PHI_DOT, PLANT_STATES, THETA, THETA_DOT

LARGEST_GAIN = 1e12
MAX_SPEED = 1e3  # [rad/s]
MAX_STEP = 5e-3  # [s]
LONGEST_RETURN = 300.0  # [s]; without a reversal for this time the arm rotates or rests


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

    @property
    def states(self) -> int:
        """Length of the state, with the bristle."""
        return PLANT_STATES

    @property
    def free(self) -> list[int]:
        """Coordinates of the state at a reversal; without φ if nothing depends on it."""
        free = [THETA, THETA_DOT] if self.l1 == 0.0 else [PHI, THETA, THETA_DOT]
        return [*free, BRISTLE] if self.law.bristle else free

    @property
    def may_rotate(self) -> bool:
        """Whether the arm can rotate steadily, because its angle is not fed back."""
        return self.l1 == 0.0

    @property
    def longest_return(self) -> float:
        """Longest time [s] between two reversals."""
        return LONGEST_RETURN

    def check(self) -> None:
        """Raise :class:`ParameterError` if it cannot be followed."""
        validated(self.body)
        check_friction(self.law.name, self.law.parameters)
        numbers = (*self.gains, self.held)
        if not all(abs(number) <= LARGEST_GAIN for number in numbers):
            limit = f"finite and at most {LARGEST_GAIN:g}"
            raise ParameterError(f"feedback and held friction must be {limit}, given {numbers}")

    def with_gains(self, gains: tuple[float, float, float, float]) -> IdealLoop:
        """The same loop with other feedback gains."""
        l1, l2, l3, l4 = gains
        return self._replace(l1=l1, l2=l2, l3=l3, l4=l4)


@compiled
def control(y: np.ndarray, loop: IdealLoop) -> float:
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
        return control(y, loop) - p.gamma * p.delta / p.beta * theta
    pull = p.gamma * cos(theta) * p.delta / p.beta * sin(theta) - p.gamma * sin(theta) * w * w
    return control(y, loop) - pull


@compiled
def sliding_rate(y: np.ndarray, force: float, dy: np.ndarray, loop: IdealLoop) -> None:
    """Compute ẏ under friction ``force`` [V] and viscous friction."""
    v = y[PHI_DOT]
    dy[PHI], dy[THETA] = v, y[THETA_DOT]
    torque = control(y, loop) - force - loop.law.parameters.viscous * v
    dy[PHI_DOT], dy[THETA_DOT] = body_accelerations(y, torque, loop)


@compiled
def stuck_rate(y: np.ndarray, dy: np.ndarray, loop: IdealLoop) -> None:
    """Compute ẏ while friction holds the arm."""
    sine = y[THETA] if loop.linear else sin(y[THETA])
    dy[PHI], dy[PHI_DOT], dy[THETA] = 0.0, 0.0, y[THETA_DOT]
    dy[THETA_DOT] = loop.body.delta / loop.body.beta * sine


@compiled
def unbounded(y: np.ndarray, loop: IdealLoop) -> bool:
    """Whether the pendulum has fallen or the arm is too fast."""
    return abs(y[THETA]) > HORIZONTAL or abs(y[PHI_DOT]) > MAX_SPEED


@compiled
def longest_step(mode: float, loop: IdealLoop) -> float:
    """Longest step of the integration [s]."""
    return MAX_STEP


@compiled
def rest_distance(y: np.ndarray, mode: float, loop: IdealLoop) -> float:
    """Distance of ``y`` from the rest that it approaches in the piece of motion ``mode``.

    Root of the sum of squares of v, θ, θ̇ [rad, rad/s] and of the torque on the arm [V]; a stuck
    arm has no torque.
    """
    torque = loop.l1 * y[PHI]
    if mode == 0.0:
        torque = 0.0
    elif loop.law.bristle:
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
    if loop.law.bristle:
        held = loop.law.parameters.sigma0 * y[BRISTLE]
    else:
        held = mode * sliding_level(0.0, mode, loop.law)
    return held / loop.l1, held
