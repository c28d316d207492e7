r"""Swings the pendulum up by shaping its energy, after Åström and Furuta (Automatica 36, 2000).

The energy of the pendulum, zero at rest upright, relative to the 2δ between hanging and upright, is

.. math::
    E = \frac{β\dot θ^2/2 + δ(\cosθ - 1)}{2δ}, \qquad
    \dot E = -\frac{γ}{2δ}\cosθ\,\dot θ\,\ddot φ + \ldots

The arm is accelerated by a sat((E − E_r)/η) sgn(θ̇ cosθ), which drives E to the target E_r. A weak
spring and damper centre the arm. The sign changes with a hysteresis, so noise does not matter at
rest. The energy is known no better than the model. But where the pendulum turns back above the
horizontal, E = (cosθ − 1)/2 whatever the inertias are: the target is raised by what was missing
there, and lowered when the pendulum passes upright too fast to be caught.
"""

from dataclasses import dataclass
from math import pi, sqrt
from typing import NamedTuple

import numpy as np

from furuta_control.modes.arm_limits import ArmLimits
from furuta_control.modes.mode import ControlledRig
from furuta_model.compiled import inlined
from furuta_model.elementary import sin_cos
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT

# Error of the energy at which the full acceleration is used, η.
FULL_ACCELERATION_ERROR = 0.15
# Stiffness and damping of the centring, relative to the pendulum's natural frequency ω.
CENTRING_FREQUENCY = 0.3
CENTRING_DAMPING = 0.2
# θ̇ cosθ relative to ω at which the sign changes.
HYSTERESIS = 0.03
# Part of the voltage that is planned for the acceleration.
USED_VOLTAGE = 0.7
# The target: at first, its largest size, its rise per missing energy and fall per fast pass.
FIRST_TARGET = 0.04
LARGEST_TARGET = 0.3
RISE = 0.5
FALL = 0.04
# cos θ above which a change of sign of θ is a pass through upright.
NEAR_UPRIGHT = 0.9


@dataclass
class EnergyShapingMemory:
    """Whether it has started, sign of the acceleration, target, last θ [rad] and θ̇ [rad/s]."""

    started: bool = False
    sign: float = 0.0
    target: float = 0.0
    last_theta: float = 0.0
    last_theta_dot: float = 0.0


class EnergyShaping(NamedTuple):
    """Pendulum's ω² [1/s²], ω [rad/s]; acceleration [rad/s²], centring [1/s²] and [1/s]."""

    squared_frequency: float
    frequency: float
    acceleration: float
    stiffness: float
    damping: float


def design(rig: ControlledRig, limits: ArmLimits) -> EnergyShaping:
    """The law for a rig.

    The acceleration is what the voltage allows, and what keeps the arm within its speed and travel
    when its sign changes once in every half period of the pendulum.
    """
    model = rig.model
    squared = model.delta / model.beta
    frequency = sqrt(squared)
    half_period = pi / frequency
    acceleration = min(
        USED_VOLTAGE * rig.voltage_limit / (model.alpha + model.beta),
        2.0 * limits.speed / half_period,
        6.6 * limits.travel / half_period**2,
    )
    return EnergyShaping(
        squared_frequency=squared,
        frequency=frequency,
        acceleration=acceleration,
        stiffness=(CENTRING_FREQUENCY * frequency) ** 2,
        damping=CENTRING_DAMPING * frequency,
    )


@inlined
def acceleration(memory: EnergyShapingMemory, x: np.ndarray, p: EnergyShaping) -> float:
    """Acceleration of the arm [rad/s²] for state ``x``."""
    theta, w = x[THETA], x[THETA_DOT]
    _, c = sin_cos(theta)
    if not memory.started:
        memory.started, memory.target = True, FIRST_TARGET
        memory.sign = 1.0 if x[PHI] < 0.0 else -1.0
    else:
        _adapt_target(memory, theta, w, c)
    memory.last_theta, memory.last_theta_dot = theta, w
    if memory.sign * w * c < -HYSTERESIS * p.frequency:
        memory.sign = -memory.sign
    energy = 0.25 * w * w / p.squared_frequency + 0.5 * (c - 1.0)
    error = (energy - memory.target) / FULL_ACCELERATION_ERROR
    shaping = p.acceleration * min(max(error, -1.0), 1.0) * memory.sign
    return shaping - p.stiffness * x[PHI] - p.damping * x[PHI_DOT]


@inlined
def _adapt_target(memory: EnergyShapingMemory, theta: float, w: float, c: float) -> None:
    """Raise the target where the pendulum turns back too early; lower it at a fast pass."""
    target = memory.target
    if c > 0.0 and w * memory.last_theta_dot < 0.0:
        target += RISE * 0.5 * (1.0 - c)
    if c > NEAR_UPRIGHT and theta * memory.last_theta < 0.0:
        target -= FALL
    memory.target = min(max(target, -LARGEST_TARGET), LARGEST_TARGET)
