"""A rig in software: the firmware on the simulated pendulum, with faults to inject.

A core without clock: ``tick`` is one sample. It is held in its initial state, as by a hand, until
it is first driven, and again after ``hold``.
"""

from __future__ import annotations

from furuta_hw.codes import wrapped
from furuta_hw.faults import Faults, Impairment
from furuta_hw.firmware import Firmware
from furuta_hw.rig import Rig
from furuta_model.state import PHI, PHI_DOT, THETA
from furuta_sim.parameters import Actuator, InitialState, PlantFriction, PlantParameters
from furuta_sim.plant import Noise, design_plant, initial_state, move


def simulated(rig: Rig, initial: InitialState | None = None, seed: int = 0) -> PlantParameters:
    """The simulated plant of a rig, with noise of one code on its analogue channels."""
    return PlantParameters(
        model=rig.model,
        friction=PlantFriction(parameters=rig.friction),
        sensors=rig.sensors,
        actuator=Actuator(rig.drive.range, 0),  # its codes are whole already
        initial=initial or InitialState(),
        sample_time=rig.line.sample_time,
        seed=seed,
    )


class EmulatedRig:
    """``receive`` bytes at any time, ``tick`` once a sample."""

    def __init__(
        self, rig: Rig, plant: PlantParameters | None = None, faults: Faults | None = None
    ) -> None:
        self.plant = plant or simulated(rig)
        self._rig = rig
        self._arm, self._speed = rig.arm.channel, rig.speed.channel
        self._pendulum, self._drive = rig.pendulum.channel, rig.drive.channel
        drive = self._drive
        self.firmware = Firmware(drive.low, drive.high, drive.to_code(0.0))
        self._noise = Noise(self.plant.seed)
        self._plant = design_plant(self.plant)
        self.faults = faults or Faults()
        self._down, self._up = Impairment(1), Impairment(2)
        self._inbox = b""
        self._stuck: int | None = None
        self.volts = 0.0
        self.hold()

    def hold(self) -> None:
        """Put the pendulum back and hold it until it is driven."""
        self.x = initial_state(self.plant)
        self.held = True
        self._driven = self.firmware.driven
        move(self.x.copy(), 0.0, self._plant)  # compiled before it counts

    def receive(self, data: bytes) -> None:
        """Bytes from the host."""
        self._inbox += data

    def take(self) -> None:
        """Let the firmware see what has come; ``tick`` does so itself."""
        data, self._inbox = self._inbox, b""
        self.firmware.receive(self._down.carry(data, self.faults))

    def tick(self) -> bytes:
        """Move on by one sample with the drive's code; then what goes out."""
        self.take()
        firmware = self.firmware
        self.held = self.held and firmware.driven == self._driven
        self.volts = self._drive.to_si(firmware.code) if firmware.armed else 0.0
        if not self.held:
            move(self.x, self.volts, self._plant)
        firmware.fault = self.faults.rig_fault
        return self._up.carry(firmware.sample(*self._codes()), self.faults)

    def _codes(self) -> tuple[int, int, int]:
        x, noise, sensors = self.x, self._noise(), self.plant.sensors
        arm = self._arm.to_code(x[PHI])
        if self.faults.encoder_stuck:
            self._stuck = arm = arm if self._stuck is None else self._stuck
        else:
            self._stuck = None
        speed, theta = 0, wrapped(x[THETA])
        if self._rig.speed.sensor == "tachometer":
            speed = self._speed.to_code(x[PHI_DOT] + sensors.tachometer_noise * noise[0])
        if self._rig.pendulum.sensor == "potentiometer":
            theta += sensors.potentiometer_noise * noise[1]
        pendulum = self._pendulum.to_code(theta)
        if self.faults.potentiometer_rail:
            pendulum = self._pendulum.high
        return arm, speed, pendulum
