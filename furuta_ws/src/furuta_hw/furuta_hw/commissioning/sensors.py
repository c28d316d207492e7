"""Finds zeros and signs of a rig's sensors: at rest, and by moving the arm a little."""

from collections.abc import Sequence
from math import pi
from typing import NamedTuple

import numpy as np

from furuta_hw.commissioning.session import Experiment, ramp
from furuta_hw.connection.rig_driver import RawCodes, RigSample
from furuta_hw.errors import RigError
from furuta_hw.rigs.channels import wrapped
from furuta_hw.rigs.rig import Rig

# Largest peak-to-peak variation of a sensor at rest, noise included [codes].
LARGEST_VARIATION = 16
# The arm has moved when its angle has changed by this, or by three counts [rad].
LEAST_MOTION = 0.02
# Rate of the voltage that moves the arm [V/s].
TEST_RATE = 1.0


def code_statistics(samples: Sequence[RigSample]) -> dict[str, float]:
    """Mean, peak-to-peak variation and number of the codes. Raises :class:`RigError` without codes.

    For the arm these are ``arm_code`` and ``arm_spread``; so for ``speed`` and ``pendulum``.
    """
    codes = np.array([sample.codes for sample in samples if sample.codes is not None])
    if len(codes) == 0:
        raise RigError("the rig driver provides no raw codes, which are needed for the zeros")
    columns = dict(zip(RawCodes._fields, codes.T, strict=True))
    means = {f"{sensor}_code": float(column.mean()) for sensor, column in columns.items()}
    spreads = {f"{sensor}_spread": int(np.ptp(column)) for sensor, column in columns.items()}
    return means | spreads | {"samples": len(codes)}


def find_zeros(samples: Sequence[RigSample], rig: Rig, hanging: bool) -> dict[str, float]:
    """Find the codes at zero: arm where it is, pendulum upright (or hanging), arm speed at rest.

    Raises :class:`RigError` if something moves.
    """
    statistics = code_statistics(samples)
    pendulum = statistics["pendulum_code"]
    for name in ("arm", "pendulum"):
        spread = statistics[f"{name}_spread"]
        if spread > LARGEST_VARIATION:
            raise RigError(f"the {name} moves: its code varied by {spread}; hold it still")
    if rig.pendulum.sensor == "potentiometer" and rig.pendulum.channel.at_rail(round(pendulum)):
        raise RigError("the pendulum's sensor is at the end of its range")
    if hanging:
        pendulum += pi / rig.pendulum.channel.per_code
    result = {"arm.zero": round(statistics["arm_code"]), "pendulum.zero": round(pendulum, 1)}
    if rig.speed.sensor == "tachometer":
        result["speed.zero"] = round(statistics["speed_code"], 1)
    return result


class Signs(NamedTuple):
    """Signs for the rig file, None where a sign was not found."""

    arm: int | None
    speed: int | None
    pendulum: int | None


def find_signs(rig: Rig, voltage: float) -> Experiment[Signs]:
    """Move the arm with a positive voltage and compare the directions of the sensors.

    The pendulum's sign is found if it hangs and its sensor measures that: it lags behind the arm,
    and by (1) its angle θ then increases with φ. Raises :class:`RigError` if the arm does not move.
    """
    start = last = yield 0.0
    threshold = max(3 * abs(rig.arm.channel.per_code), LEAST_MOTION)
    voltages = ramp(TEST_RATE, voltage, rig.line.sample_time)
    integrated_speed = 0.0
    while abs(last.arm_angle - start.arm_angle) < threshold:
        last = yield next(voltages)
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
