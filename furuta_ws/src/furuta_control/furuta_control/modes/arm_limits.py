"""Keeps the arm within its travel and speed while the pendulum is swung up, caught and balanced.

The arm may move towards a limit only as fast as it can still be stopped before it: with the braking
acceleration a_b and the distance d to the limit, at most √(2 a_b d). A command that would make it
faster is limited to the voltage that brings the speed back within the response time.
"""

from math import sqrt
from typing import NamedTuple

from furuta_control.modes.mode import ControlledRig
from furuta_model.compiled import compiled

# Parts of the limits that are used; the rest is for noise, delay and errors of the model.
USED_TRAVEL = 0.7
USED_SPEED = 0.8
# Part of the voltage that is planned for braking; the rest is for friction and coupling.
BRAKING_VOLTAGE = 0.4
# Part of the voltage that viscous friction may take at the highest speed.
DRIVING_VOLTAGE = 0.85
# Samples in which a speed that is not allowed is corrected.
RESPONSE = 10.0
# Braking, relative to the planned one, at which an arm that cannot stop counts as out of control.
HARDEST_BRAKING = 1.8


class ArmLimits(NamedTuple):
    """Used travel either side of 0 [rad] and speed [rad/s], braking [rad/s²], response time [s].

    ``last_travel`` and ``last_speed`` are the limits themselves.
    """

    travel: float
    speed: float
    braking: float
    response: float
    last_travel: float
    last_speed: float


def design(rig: ControlledRig, angle_limit: float, speed_limit: float) -> ArmLimits:
    """The limits for a rig. The braking is that with the pendulum horizontal, the heaviest.

    The speed is also one at which viscous friction, back-EMF included, leaves voltage.
    """
    speed = USED_SPEED * speed_limit
    if rig.viscous > 0.0:
        speed = min(speed, DRIVING_VOLTAGE * rig.voltage_limit / rig.viscous)
    return ArmLimits(
        travel=USED_TRAVEL * angle_limit,
        speed=speed,
        braking=BRAKING_VOLTAGE * rig.voltage_limit / (rig.model.alpha + rig.model.beta),
        response=RESPONSE * rig.sample_time,
        last_travel=angle_limit,
        last_speed=speed_limit,
    )


@compiled
def limited(acceleration: float, phi: float, phi_dot: float, p: ArmLimits) -> float:
    """The acceleration [rad/s²] nearest to the given one that keeps the arm within its limits."""
    high = (_largest_speed(p.travel - phi, p) - phi_dot) / p.response
    low = (-_largest_speed(p.travel + phi, p) - phi_dot) / p.response
    return min(max(acceleration, low), high)


@compiled
def _largest_speed(distance: float, p: ArmLimits) -> float:
    """Largest speed [rad/s] towards a limit at this ``distance`` [rad]; negative beyond it."""
    speed = min(sqrt(2.0 * p.braking * abs(distance)), p.speed)
    return speed if distance > 0.0 else -speed


@compiled
def can_stop(phi: float, phi_dot: float, p: ArmLimits) -> bool:
    """Whether the arm is within its limits and can be stopped before their ends by hard braking."""
    path = 0.5 * phi_dot * abs(phi_dot) / (HARDEST_BRAKING * p.braking)
    return abs(phi + path) <= p.last_travel and abs(phi_dot) <= p.last_speed
