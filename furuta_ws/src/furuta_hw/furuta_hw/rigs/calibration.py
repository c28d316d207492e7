"""Calibration of a rig's sensors and drive: sections ``arm``, ``speed``, ``pendulum``, ``drive``.

The defaults are the rig of the paper, Section 4.
"""

from math import pi
from typing import Annotated, NamedTuple

from furuta_hw.rigs.channels import Channel, converter, encoder
from furuta_model.parameters import About

_SIGN = About("+1 or -1: the direction in which codes count", "", -1, 1)
_ZERO = About("code at zero", "codes", -1e9, 1e9)
_BITS = About("bits of the converter", "", 2, 16)
_COUNTS = About("counts per turn of the encoder", "", 1, 2**24)


class ArmEncoder(NamedTuple):
    """The encoder of the arm angle φ. A positive voltage drives the arm towards positive φ."""

    counts_per_turn: Annotated[int, _COUNTS] = 250
    sign: Annotated[int, _SIGN] = 1
    zero: Annotated[float, _ZERO] = 0.0

    @property
    def channel(self) -> Channel:
        """Codes ↔ φ [rad]."""
        return encoder(self.counts_per_turn, self.sign, self.zero)


class SpeedSensor(NamedTuple):
    """The source of the arm speed φ̇: a tachometer, or the counts of the arm's encoder."""

    sensor: Annotated[
        str,
        About(
            "tachometer: AD converter; encoder: filtered difference of the arm's counts",
            choices=("tachometer", "encoder"),
        ),
    ] = "tachometer"
    range: Annotated[float, About("tachometer at full scale", "rad/s", 1e-3, 1e4)] = 10.0
    bits: Annotated[int, _BITS] = 12
    sign: Annotated[int, _SIGN] = 1
    zero: Annotated[float, _ZERO] = 0.0
    bandwidth: Annotated[float, About("filter on the encoder's speed", "rad/s", 0.1, 1e5)] = 200.0

    @property
    def channel(self) -> Channel:
        """Codes ↔ φ̇ [rad/s]."""
        return converter(self.range, self.bits, self.sign, self.zero)


class PendulumSensor(NamedTuple):
    """The sensor of the pendulum angle θ, zero upright."""

    sensor: Annotated[
        str,
        About("potentiometer (AD converter) or encoder", choices=("potentiometer", "encoder")),
    ] = "potentiometer"
    range: Annotated[float, About("potentiometer at full scale", "rad", 1e-3, 2 * pi)] = pi / 4
    bits: Annotated[int, _BITS] = 12
    counts_per_turn: Annotated[int, _COUNTS] = 4096
    sign: Annotated[int, _SIGN] = 1
    zero: Annotated[float, _ZERO] = 0.0

    @property
    def channel(self) -> Channel:
        """Codes ↔ θ [rad]."""
        if self.sensor == "encoder":
            return encoder(self.counts_per_turn, self.sign, self.zero)
        return converter(self.range, self.bits, self.sign, self.zero)


class DriveConverter(NamedTuple):
    """The DA converter of the drive, and what delays the torque."""

    range: Annotated[float, About("voltage at full scale", "V", 1e-3, 1e3)] = 10.0
    bits: Annotated[int, _BITS] = 12
    sign: Annotated[int, _SIGN] = 1
    zero: Annotated[float, _ZERO] = 0.0
    delay: Annotated[float, About("dead time between command and torque", "s", 0, 0.1)] = 0.0
    lag: Annotated[float, About("time constant of the torque", "s", 0, 1)] = 0.0
    torque_per_volt: Annotated[
        float, About("torque on the arm, for simulators; 1 if it is not known", "N m/V", 1e-9, 1e6)
    ] = 1.0

    @property
    def channel(self) -> Channel:
        """Codes ↔ u [V]."""
        return converter(self.range, self.bits, self.sign, self.zero)
