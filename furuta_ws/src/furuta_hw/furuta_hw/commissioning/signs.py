"""Finds the signs of a rig's sensors by moving the arm a little."""

from math import pi
from typing import NamedTuple

from furuta_hw.commissioning.session import Experiment
from furuta_hw.rigs.channels import wrapped
from furuta_hw.rigs.rig import Rig

# The arm has moved when its angle has changed by this, or by three counts [rad].
LEAST_MOTION = 0.02


class Signs(NamedTuple):
    """Signs for the rig file, None where a sign was not found."""

    arm: int | None
    speed: int | None
    pendulum: int | None


def find_signs(rig: Rig, voltage: float) -> Experiment[Signs]:
    """Move the arm with a positive voltage and compare the directions of the sensors.

    The pendulum's sign is found if it hangs and its sensor measures that: it lags behind the arm,
    and by (1) its angle θ then increases with φ.
    """
    start = last = yield 0.0
    threshold = max(3 * abs(rig.arm.channel.per_code), LEAST_MOTION)
    u = integrated_speed = 0.0
    while abs(last.arm_angle - start.arm_angle) < threshold:
        u = min(u + rig.line.sample_time, voltage)
        last = yield u
        integrated_speed += last.arm_speed * rig.line.sample_time
    forward = last.arm_angle > start.arm_angle
    arm_sign = rig.arm.sign * (1 if forward else -1)
    # A speed sensor that agrees with a reversed encoder is reversed too.
    same_direction = (integrated_speed > 0) == forward
    speed_sign = rig.speed.sign * (1 if same_direction == forward else -1)
    lag = wrapped(last.pendulum_angle - start.pendulum_angle)
    hanging = abs(start.pendulum_angle) > 0.75 * pi and abs(lag) > 0
    return Signs(
        arm_sign,
        speed_sign if rig.speed.sensor == "tachometer" else None,
        rig.pendulum.sign * (1 if lag > 0 else -1) if hanging else None,
    )
