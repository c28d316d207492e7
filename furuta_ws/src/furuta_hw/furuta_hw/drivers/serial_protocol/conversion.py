"""Conversion of a frame's codes to a sample in SI units."""

from math import exp

from furuta_hw.connection.rig_driver import RawCodes, RigSample
from furuta_hw.protocol.frames import ARMED, FAULT, WATCHDOG, SensorsFrame
from furuta_hw.rigs.channels import wrapped
from furuta_hw.rigs.rig import Rig


class SampleConverter:
    """Converts the frames of one session, in order.

    Without a tachometer the arm speed is the difference of the arm's angles behind a first-order
    low-pass filter, exact for gaps of any number of samples.
    """

    def __init__(self, rig: Rig) -> None:
        self._arm, self._speed = rig.arm.channel, rig.speed.channel
        self._pendulum, self._drive = rig.pendulum.channel, rig.drive.channel
        self._has_tachometer = rig.speed.sensor == "tachometer"
        self._has_potentiometer = rig.pendulum.sensor == "potentiometer"
        self._dt = rig.line.sample_time
        self._decay = rig.speed.bandwidth * rig.line.sample_time
        self._last_number: int | None = None
        self._arm_angle = self._arm_speed = 0.0

    def convert(self, frame: SensorsFrame) -> RigSample:
        """Convert the next frame."""
        arm_angle = self._arm.to_si(frame.arm)
        if self._has_tachometer:
            self._arm_speed = self._speed.to_si(frame.speed)
        else:
            self._filter_speed(arm_angle, frame.sample)
        self._arm_angle, self._last_number = arm_angle, frame.sample
        return RigSample(
            frame.sample,
            arm_angle,
            self._arm_speed,
            wrapped(self._pendulum.to_si(frame.pendulum)),
            self._drive.to_si(frame.drive),
            bool(frame.status & ARMED),
            bool(frame.status & FAULT),
            bool(frame.status & WATCHDOG),
            (self._has_tachometer and self._speed.at_rail(frame.speed))
            or (self._has_potentiometer and self._pendulum.at_rail(frame.pendulum)),
            RawCodes(frame.arm, frame.speed, frame.pendulum),
        )

    def _filter_speed(self, arm_angle: float, number: int) -> None:
        if self._last_number is None:
            return
        steps = (number - self._last_number) % 2**32
        if steps:
            difference = (arm_angle - self._arm_angle) / (steps * self._dt)
            share = 1.0 - exp(-self._decay * steps)
            self._arm_speed += share * (difference - self._arm_speed)
