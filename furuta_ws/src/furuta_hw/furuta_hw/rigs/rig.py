"""A rig: its model, friction, calibration, line and safety limits.

The defaults are the rig of the paper, Section 4.
"""

from math import pi
from typing import Annotated, NamedTuple

from furuta_hw.rigs.calibration import ArmEncoder, DriveConverter, PendulumSensor, SpeedSensor
from furuta_model.friction.parameters import Friction
from furuta_model.late_drive import Drive, LateDrive
from furuta_model.linear import DesiredPoles, KalmanParameters
from furuta_model.parameters import About, ParameterError
from furuta_model.parts.coupling import Coupling
from furuta_model.parts.disturbances import Tilt, TorqueWaves
from furuta_model.parts.motion import PendulumFriction
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors


class RigLine(NamedTuple):
    """The line to the rig, the driver that uses it, and the rig's timing."""

    driver: Annotated[
        str, About("rig driver: a module of furuta_hw/drivers, or one of own_parts")
    ] = "serial_protocol"
    baud: Annotated[int, About("bits per second", "1/s", 1200, 12_000_000)] = 1_000_000
    sample_time: Annotated[float, About("time between samples", "s", 1e-4, 0.1)] = 0.001
    watchdog: Annotated[
        float, About("time without a new voltage after which the rig sets 0 V", "s", 1e-3, 1.0)
    ] = 0.05


class SafetyLimits(NamedTuple):
    """Limits on the voltage, and conditions that stop the rig."""

    voltage: Annotated[float, About("largest voltage", "V", 0.0, 1e3)] = 10.0
    slew_rate: Annotated[float, About("largest change of the voltage", "V/s", 1.0, 1e7)] = 1000.0
    pendulum_angle: Annotated[
        float, About("stop beyond this |θ|; above π: never", "rad", 0.01, 2 * pi)
    ] = 0.75
    arm_angle: Annotated[float, About("stop beyond this |φ|", "rad", 0.01, 1e6)] = 2 * pi
    arm_speed: Annotated[float, About("stop beyond this |φ̇|", "rad/s", 0.1, 1e6)] = 9.9
    command_age: Annotated[
        float, About("stop if no command follows a measurement for", "s", 1e-3, 10.0)
    ] = 0.05
    estimate_age: Annotated[
        float, About("stop if no friction estimate follows a measurement for", "s", 1e-3, 1e9)
    ] = 0.03
    measurement_age: Annotated[float, About("stop without measurement for", "s", 1e-3, 10.0)] = 0.05
    bad_frames: Annotated[
        float,
        About("stop at this fraction of frames lost or corrupt, over a second", "", 1e-4, 1.0),
    ] = 0.1
    disagreement: Annotated[
        float, About("stop if encoder and tachometer differ by this in a second", "rad", 1e-3, 1e3)
    ] = 0.5


class Rig(NamedTuple):
    """Everything that a rig file describes."""

    model: FurutaPendulum = FurutaPendulum()
    friction: Friction = Friction()
    arm: ArmEncoder = ArmEncoder()
    speed: SpeedSensor = SpeedSensor()
    pendulum: PendulumSensor = PendulumSensor()
    drive: DriveConverter = DriveConverter()
    line: RigLine = RigLine()
    limits: SafetyLimits = SafetyLimits()
    coupling: Coupling = Coupling()
    pendulum_friction: PendulumFriction = PendulumFriction()
    tilt: Tilt = Tilt()
    waves: TorqueWaves = TorqueWaves()
    poles: DesiredPoles = DesiredPoles()
    kalman: KalmanParameters = KalmanParameters()

    def check(self) -> None:
        """Reject a sign other than ±1 and a watchdog shorter than two samples."""
        for name in ("arm", "speed", "pendulum", "drive"):
            if getattr(self, name).sign not in (-1, 1):
                raise ParameterError(f"{name}.sign must be 1 or -1, given 0")
        if not 2 <= self.watchdog_samples <= 0xFFFF:
            raise ParameterError(
                f"line.watchdog must be 2 to 65535 samples, given {self.watchdog_samples}"
            )

    @property
    def sensors(self) -> Sensors:
        """The sensors as estimator and simulator model them.

        Analogue channels have noise of one code. A speed from differenced counts is as accurate
        as one count over the low-pass's time. An encoder on the pendulum is a potentiometer without
        noise whose codes are the counts, and whose range exceeds the circle.
        """
        arm, speed, pendulum = self.arm, self.speed, self.pendulum
        tachometer, potentiometer = speed.sensor == "tachometer", pendulum.sensor != "encoder"
        count, bits = abs(pendulum.channel.per_code), pendulum.counts_per_turn.bit_length()
        return Sensors(
            encoder_counts=arm.counts_per_turn,
            tachometer_range=speed.range if tachometer else self.limits.arm_speed,
            tachometer_bits=speed.bits if tachometer else 0,
            tachometer_noise=abs(speed.channel.per_code)
            if tachometer
            else 0.5 * speed.bandwidth * abs(arm.channel.per_code),
            potentiometer_range=pendulum.range if potentiometer else count * 2 ** (bits - 1),
            potentiometer_bits=pendulum.bits if potentiometer else bits,
            potentiometer_noise=count if potentiometer else 0.0,
        )

    @property
    def drive_dynamics(self) -> Drive:
        """Delay and lag of the drive as the simulator models them."""
        samples = round(self.drive.delay / self.line.sample_time)
        return Drive(LateDrive(samples, self.drive.lag))

    @property
    def watchdog_samples(self) -> int:
        """The rig's watchdog in samples."""
        return round(self.line.watchdog / self.line.sample_time)

    @property
    def period_us(self) -> int:
        """The sample time in whole microseconds, as the protocol transmits it [µs]."""
        return round(self.line.sample_time * 1e6)
