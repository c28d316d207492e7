"""A rig: its model, the calibration of its channels, its line and its limits.

The defaults are the paper's rig, Section 4.
"""

from __future__ import annotations

from math import pi, sqrt
from typing import Annotated, NamedTuple

from furuta_hw.codes import Channel, converter, encoder
from furuta_model.friction.parameters import LuGre
from furuta_model.parameters import About, ParameterError
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors

_SIGN = About("+1 or -1: which way codes count", "", -1, 1)
_ZERO = About("code at zero", "codes", -1e9, 1e9)
_BITS = About("bits of the converter", "", 2, 16)
_COUNTS = About("counts per turn of the encoder", "", 1, 2**24)


class Arm(NamedTuple):
    """The encoder of the arm angle φ, positive in the direction that a positive voltage drives."""

    counts_per_turn: Annotated[int, _COUNTS] = 250
    sign: Annotated[int, _SIGN] = 1
    zero: Annotated[float, _ZERO] = 0.0

    @property
    def channel(self) -> Channel:
        """Codes ↔ φ [rad]."""
        return encoder(self.counts_per_turn, self.sign, self.zero)


class Speed(NamedTuple):
    """Where the arm speed comes from: a tachometer, or the encoder's counts."""

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
    bandwidth: Annotated[float, About("of the difference's low-pass", "rad/s", 0.1, 1e5)] = 200.0

    @property
    def channel(self) -> Channel:
        """Codes ↔ φ̇ [rad/s]."""
        return converter(self.range, self.bits, self.sign, self.zero)


class Pendulum(NamedTuple):
    """The sensor of the pendulum angle θ, zero upright."""

    sensor: Annotated[
        str, About("potentiometer: AD converter; encoder", choices=("potentiometer", "encoder"))
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


class Drive(NamedTuple):
    """The DA converter of the drive."""

    range: Annotated[float, About("voltage at full scale", "V", 1e-3, 1e3)] = 10.0
    bits: Annotated[int, _BITS] = 12
    sign: Annotated[int, _SIGN] = 1
    zero: Annotated[float, _ZERO] = 0.0

    @property
    def channel(self) -> Channel:
        """Codes ↔ u [V]."""
        return converter(self.range, self.bits, self.sign, self.zero)


class Line(NamedTuple):
    """The serial line and the time that the rig keeps."""

    baud: Annotated[int, About("bits per second", "1/s", 1200, 12_000_000)] = 1_000_000
    sample_time: Annotated[float, About("time between samples", "s", 1e-4, 0.1)] = 0.001
    watchdog: Annotated[
        float, About("without a fresh drive frame the rig goes to 0 V", "s", 1e-3, 1.0)
    ] = 0.05


class Limits(NamedTuple):
    """What the bridge lets through, and where it stops."""

    voltage: Annotated[float, About("largest voltage", "V", 0.0, 1e3)] = 10.0
    slew_rate: Annotated[float, About("largest change of the voltage", "V/s", 1.0, 1e7)] = 1000.0
    pendulum_angle: Annotated[float, About("stop beyond this |θ|", "rad", 0.01, pi)] = 0.75
    arm_angle: Annotated[float, About("stop beyond this |φ|", "rad", 0.01, 1e6)] = 2 * pi
    arm_speed: Annotated[float, About("stop beyond this |φ̇|", "rad/s", 0.1, 1e6)] = 9.9
    command_age: Annotated[
        float, About("stop when a measurement has no command for", "s", 1e-3, 10.0)
    ] = 0.05
    estimate_age: Annotated[
        float, About("stop when a measurement has no friction estimate for", "s", 1e-3, 1e9)
    ] = 0.03
    measurement_age: Annotated[float, About("stop without measurement for", "s", 1e-3, 10.0)] = 0.05
    bad_frames: Annotated[
        float, About("stop at this part of frames lost or corrupt, over a second", "", 1e-4, 1.0)
    ] = 0.1
    disagreement: Annotated[
        float, About("stop where encoder and tachometer differ by, over a second", "rad", 1e-3, 1e3)
    ] = 0.5


class Rig(NamedTuple):
    """A rig, whole."""

    model: FurutaPendulum = FurutaPendulum()
    friction: LuGre = LuGre()
    arm: Arm = Arm()
    speed: Speed = Speed()
    pendulum: Pendulum = Pendulum()
    drive: Drive = Drive()
    line: Line = Line()
    limits: Limits = Limits()

    def check(self) -> None:
        """Refuse a sign that is none, and a watchdog shorter than two samples."""
        for name in ("arm", "speed", "pendulum", "drive"):
            if getattr(self, name).sign not in (-1, 1):
                raise ParameterError(f"{name}.sign must be 1 or -1, given 0")
        if not 2 <= self.watchdog_samples <= 0xFFFF:
            raise ParameterError(
                f"line.watchdog must be 2 to 65535 samples, given {self.watchdog_samples}"
            )

    @property
    def sensors(self) -> Sensors:
        """What estimator and simulator need to know: noise of one code on analogue channels.

        A speed differenced from counts is as good as a count over the low-pass's time; an
        encoder on the pendulum is a fine potentiometer.
        """
        arm, speed, pendulum = self.arm, self.speed, self.pendulum
        tachometer, potentiometer = speed.sensor == "tachometer", pendulum.sensor != "encoder"
        count = abs(pendulum.channel.per_code)
        return Sensors(
            encoder_counts=arm.counts_per_turn,
            tachometer_range=speed.range if tachometer else self.limits.arm_speed,
            tachometer_bits=speed.bits if tachometer else 0,
            tachometer_noise=abs(speed.channel.per_code)
            if tachometer
            else 0.5 * speed.bandwidth * abs(arm.channel.per_code),
            potentiometer_range=pendulum.range if potentiometer else pi,
            potentiometer_bits=pendulum.bits if potentiometer else 0,
            potentiometer_noise=count if potentiometer else count / sqrt(12.0),
        )

    @property
    def watchdog_samples(self) -> int:
        """The rig's watchdog in samples."""
        return round(self.line.watchdog / self.line.sample_time)

    @property
    def period_us(self) -> int:
        """The sample time as the protocol has it [µs]."""
        return round(self.line.sample_time * 1e6)
