"""Measures the zeros of a rig's sensors, from the raw codes of samples."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from typing import NamedTuple

import numpy as np

from furuta_hw.connection.rig_driver import RigSample
from furuta_hw.errors import DriverError, NotStillError
from furuta_hw.rigs.rig import Rig

# Largest peak-to-peak variation of a sensor at rest, noise included [codes].
LARGEST_VARIATION = 16


class CodeStatistics(NamedTuple):
    """Mean and peak-to-peak variation of each sensor's codes."""

    arm_code: float
    speed_code: float
    pendulum_code: float
    arm_spread: int
    speed_spread: int
    pendulum_spread: int
    samples: int


def code_statistics(samples: Sequence[RigSample]) -> CodeStatistics:
    """Compute the statistics of all samples' codes. Raises :class:`DriverError` without codes."""
    codes = np.array([sample.codes for sample in samples if sample.codes is not None])
    if len(codes) == 0:
        raise DriverError("the rig driver provides no raw codes, which are needed for the zeros")
    means, spreads = codes.mean(axis=0), np.ptp(codes, axis=0)
    (arm, speed, pendulum), (a, s, p) = map(float, means), map(int, spreads)
    return CodeStatistics(arm, speed, pendulum, a, s, p, len(codes))


def find_zeros(samples: Sequence[RigSample], rig: Rig, hanging: bool) -> dict[str, float]:
    """Find the codes at zero: arm where it is, pendulum upright (or hanging), arm speed at rest.

    Raises :class:`NotStillError` if something moves.
    """
    statistics = code_statistics(samples)
    pendulum = statistics.pendulum_code
    for name, spread in (("arm", statistics.arm_spread), ("pendulum", statistics.pendulum_spread)):
        if spread > LARGEST_VARIATION:
            raise NotStillError(f"the {name} moves: its code varied by {spread}; hold it still")
    if rig.pendulum.sensor == "potentiometer" and rig.pendulum.channel.at_rail(round(pendulum)):
        raise NotStillError("the pendulum's sensor is at the end of its range")
    if hanging:
        pendulum += pi / rig.pendulum.channel.per_code
    result = {"arm.zero": round(statistics.arm_code), "pendulum.zero": round(pendulum, 1)}
    if rig.speed.sensor == "tachometer":
        result["speed.zero"] = round(statistics.speed_code, 1)
    return result
