"""An emulated rig: firmware on the simulated pendulum, with faults to inject.

It has no clock: ``step`` is one sample. The pendulum is held in its initial state until the rig is
first driven, and again after ``hold``.
"""

from collections import deque
from collections.abc import Callable
from time import monotonic, sleep
from typing import Any

import numpy as np

from furuta_hw.emulator.faults import Faults, FaultyLine, build_from_known
from furuta_hw.emulator.firmware import Firmware
from furuta_hw.rigs.channels import wrapped
from furuta_hw.rigs.rig import Rig
from furuta_model.block import block
from furuta_model.compiled import for_types_of
from furuta_model.parts.sensor_faults import sensed_state
from furuta_model.sensors import Actuator
from furuta_model.state import PHI, PHI_DOT, THETA
from furuta_sim.parameters import InitialState, PlantFriction, PlantParameters
from furuta_sim.plant import Noise, design_plant, initial_plant, move_block


def plant_of(rig: Rig, initial: InitialState | None = None, seed: int = 0) -> PlantParameters:
    """Parameters of a rig's simulated plant, with noise of one code on analogue channels."""
    return PlantParameters(
        model=rig.model,
        friction=PlantFriction(parameters=rig.friction),
        sensors=rig.sensors,
        actuator=Actuator(rig.drive.range, 0),  # the drive's codes are quantised already
        drive=rig.drive_dynamics,
        coupling=rig.coupling,
        pendulum_friction=rig.pendulum_friction,
        waves=rig.waves,
        tilt=rig.tilt,
        initial=initial or InitialState(),
        sample_time=rig.line.sample_time,
        seed=seed,
    )


def initial_state_of(given: dict[str, Any]) -> InitialState:
    """The initial state with these values; ParameterError for a wrong name or value."""
    return build_from_known(InitialState, given, "state")


class EmulatedRig:
    """Call ``receive`` with bytes at any time, and ``step`` once a sample."""

    def __init__(
        self,
        rig: Rig,
        plant: PlantParameters | None = None,
        faults: Faults | None = None,
        make_firmware: Callable[[int, int, int], Firmware] = Firmware,
    ) -> None:
        self.plant = plant or plant_of(rig)
        self._rig = rig
        self._arm, self._speed = rig.arm.channel, rig.speed.channel
        self._pendulum, self._drive = rig.pendulum.channel, rig.drive.channel
        drive = self._drive
        self.firmware = make_firmware(drive.low, drive.high, drive.to_code(0.0))
        self._noise = Noise(self.plant.seed)
        self._plant = block(design_plant(self.plant))
        self.faults = faults or Faults()
        self._line_to_rig, self._line_to_host = FaultyLine(1), FaultyLine(2)
        self._inbox: deque[bytes] = deque()  # two threads use it: MockPort
        self.volts = 0.0  # applied over the last sample
        self._memory = initial_plant(self.plant)
        self._arm_code = self._arm.to_code(self.x[PHI])
        self.held = True
        self._driven_before = 0
        self._move = for_types_of(move_block, self._memory, 0.0, self._plant)

    @property
    def x(self) -> np.ndarray:
        """Plant state (5,)."""
        state: np.ndarray = self._memory["x"][0]
        return state

    @property
    def drive_volts(self) -> float:
        """The voltage that the drive holds now [V]."""
        return self._drive.to_si(self.firmware.code) if self.firmware.armed else 0.0

    def hold(self, initial: InitialState | None = None) -> None:
        """Hold the pendulum in its initial state, or another one, until the rig is driven."""
        if initial is not None:
            self.plant = self.plant._replace(initial=initial)
        self._memory = initial_plant(self.plant)
        self.held = True
        self._driven_before = self.firmware.driven

    def receive(self, data: bytes) -> None:
        """Receive bytes from the host."""
        self._inbox.append(data)

    def process_input(self) -> None:
        """Pass received bytes to the firmware; ``step`` does so itself."""
        data = b"".join(self._inbox.popleft() for _ in range(len(self._inbox)))
        self.firmware.receive(self._line_to_rig.carry(data, self.faults))

    def step(self) -> bytes:
        """Advance by one sample; returns the bytes for the host."""
        self.process_input()
        firmware = self.firmware
        self.held = self.held and firmware.driven == self._driven_before
        self.volts = self.drive_volts
        if not self.held:
            self._move(self._memory, self.volts, self._plant)
        firmware.fault = self.faults.rig_fault
        return self._line_to_host.carry(firmware.sample(*self._codes()), self.faults)

    def _codes(self) -> tuple[int, int, int]:
        x, noise, sensors = self.x, self._noise(), self.plant.sensors
        memory, on_motor = self._memory[0], self.plant.coupling.senses_motor
        if not self.faults.encoder_stuck:
            self._arm_code = self._arm.to_code(sensed_state(memory, PHI, on_motor))
        speed, theta = 0, wrapped(x[THETA])
        if self._rig.speed.sensor == "tachometer":
            arm_speed = sensed_state(memory, PHI_DOT, on_motor)
            speed = self._speed.to_code(arm_speed + sensors.tachometer_noise * noise[0])
        if self._rig.pendulum.sensor == "potentiometer":
            theta += sensors.potentiometer_noise * noise[1]
        pendulum = self._pendulum.to_code(theta)
        if self.faults.potentiometer_rail:
            pendulum = self._pendulum.high
        return self._arm_code, speed, pendulum


class MockPort:
    """Port of the rig drivers to an emulated rig. Its time runs while it is read."""

    def __init__(self, rig: Rig) -> None:
        self._rig = EmulatedRig(rig)
        self._period = rig.line.sample_time
        self._next = monotonic() + self._period

    def read(self) -> bytes:
        """Wait until the next sample is due, and return its bytes."""
        sleep(max(0.0, self._next - monotonic()))
        self._next = max(self._next + self._period, monotonic())
        return self._rig.step()

    def write(self, data: bytes) -> None:
        """Send to the rig."""
        self._rig.receive(data)

    def close(self) -> None:
        """Do nothing: there is nothing to free."""
