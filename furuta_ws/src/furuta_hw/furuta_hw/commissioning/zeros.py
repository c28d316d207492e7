"""Measures the zeros of a rig's sensors, from the raw codes of samples."""

from collections.abc import Sequence
from math import pi

import numpy as np

from furuta_hw.connection.rig_driver import RawCodes, RigSample
from furuta_hw.errors import RigError
from furuta_hw.rigs.rig import Rig

# Largest peak-to-peak variation of a sensor at rest, noise included [codes].
LARGEST_VARIATION = 16


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
