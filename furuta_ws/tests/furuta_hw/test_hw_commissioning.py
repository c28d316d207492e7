"""Commissioning of emulated rigs whose true parameters are known."""

from math import inf, pi

import numpy as np
import pytest

from furuta_hw.commissioning import RAMP_RATE
from furuta_hw.commissioning.friction import (
    check_hanging,
    measure_friction,
)
from furuta_hw.commissioning.sensors import find_signs, find_zeros
from furuta_hw.commissioning.session import Experiment
from furuta_hw.connection.rig_driver import RigSample
from furuta_hw.drivers.serial_protocol.driver import SampleConverter
from furuta_hw.emulator.emulated_rig import EmulatedRig, plant_of
from furuta_hw.errors import RigError
from furuta_hw.protocol.frames import FrameReader, SensorsFrame
from furuta_hw.rigs.calibration import ArmEncoder, PendulumSensor, SpeedSensor
from furuta_hw.rigs.rig import Rig
from furuta_model.friction.parameters import Friction
from furuta_sim.parameters import InitialState

HANGING = InitialState(theta=pi)


class DrivenRig(EmulatedRig):
    """An emulated rig whose voltage is set directly, without a line."""

    def drive(self, volts: float) -> SensorsFrame:
        """One sample at this voltage."""
        self.held = False
        firmware = self.firmware
        firmware.session, firmware.watchdog, firmware.answered = 0, 2, firmware.number
        firmware.code, firmware._status = self._drive.to_code(volts), 1
        (frame,) = FrameReader().read(self.step())
        assert isinstance(frame, SensorsFrame)
        return frame


def perform(rig: Rig, experiment: Experiment, true: Rig | None = None) -> tuple:
    """Run an experiment with the rig file ``rig`` on a rig that is really ``true``."""
    true = true or rig
    body = DrivenRig(true, plant_of(true, HANGING))
    converter, furthest = SampleConverter(rig), 0.0
    volts = next(experiment)
    try:
        while True:
            sample = converter.convert(body.drive(volts))
            furthest = max(furthest, abs(sample.arm_angle))
            volts = experiment.send(sample)
    except StopIteration as done:
        return done.value, furthest


def test_friction_is_found() -> None:
    """Levels, asymmetry and viscous part, from one count of 25 mrad and a noisy tachometer."""
    friction = Friction(asymmetry=0.15, viscous=0.05)
    rig = Rig(friction=friction)
    messages: list[str] = []
    found, furthest = perform(rig, measure_friction(rig, RAMP_RATE, messages.append))
    assert found.alpha0 == pytest.approx(friction.alpha0, rel=0.01)
    stiction = friction.alpha0 + friction.alpha1
    assert found.alpha0 + found.alpha1 == pytest.approx(stiction, rel=0.04)
    assert found.asymmetry == pytest.approx(friction.asymmetry, abs=0.01)
    assert found.viscous == pytest.approx(friction.viscous, abs=0.005)
    assert furthest < 3.0
    assert messages[:2] + messages[-1:] == ["ramp 1 of 6", "ramp 2 of 6", "slide 8 of 8"]
    assert len(messages) == 14


def test_friction_needs_a_pendulum_that_hangs_at_rest() -> None:
    """An upright or swinging one is refused; beyond the sensor's range it cannot be upright."""
    full_turn = Rig(pendulum=PendulumSensor(sensor="encoder", counts_per_turn=8192))
    for rig in (Rig(), full_turn):
        check_hanging(still(rig, pi))
        for theta in (0.0, 0.3, -0.3):
            with pytest.raises(RigError, match="must hang, but its sensor reads"):
                check_hanging(still(rig, theta, 2))
    hanging = still(full_turn, pi)
    swinging = [
        sample._replace(pendulum_angle=pi + 0.2 * np.sin(0.005 * k))
        for k, sample in enumerate(hanging)
    ]
    with pytest.raises(RigError, match="swings by"):
        check_hanging(swinging)


@pytest.mark.parametrize(("arm", "speed"), [(-1, 1), (1, -1)])
def test_signs_are_found(arm: int, speed: int) -> None:
    """For every wiring of encoder and tachometer, with the default rig file."""
    true = Rig(arm=ArmEncoder(sign=arm), speed=SpeedSensor(sign=speed))
    found, furthest = perform(Rig(), find_signs(Rig(), 1.0), true)
    assert (found.arm, found.speed, found.pendulum) == (arm, speed, None)
    assert furthest < 0.2


def test_sign_of_a_hanging_pendulum() -> None:
    """Measured by an encoder, it lags behind the arm."""
    given = Rig(pendulum=PendulumSensor(sensor="encoder", counts_per_turn=8192))
    true = given._replace(pendulum=given.pendulum._replace(sign=-1))
    assert perform(given, find_signs(given, 1.0), true)[0].pendulum == -1


def volts_of(experiment: Experiment, rig: Rig) -> list[float]:
    """Perform an experiment that fails, and return its voltages [V]."""
    volts = []

    def watched() -> Experiment:
        sample = None
        while True:
            volts.append(experiment.send(sample))
            sample = yield volts[-1]

    with pytest.raises(RigError) as failure:
        perform(rig, watched())
    assert str(failure.value).endswith(" at 0.5 V; raise --voltage or check the motor")
    return volts


def test_an_arm_that_does_not_move_ends_the_search_for_signs() -> None:
    """A blocked arm is left a second after the largest voltage has been reached."""
    blocked = Rig(friction=Friction(alpha0=50.0))
    volts = volts_of(find_signs(blocked, 0.5), blocked)
    assert len(volts) * blocked.line.sample_time == pytest.approx(1.5, abs=0.01)
    assert max(volts) == 0.5


@pytest.mark.parametrize(
    ("friction", "seconds"),
    [(Friction(alpha0=50.0), 1.25), (Friction(viscous=2.0), inf)],
    ids=["blocked", "slow"],
)
def test_an_arm_that_does_not_move_ends_the_measurement(friction: Friction, seconds: float) -> None:
    """A blocked arm as above; a slow one when a slide has not got its voltage."""
    rig = Rig(friction=friction)
    volts = volts_of(measure_friction(rig, 2.0, lambda motion: None, 0.5), rig)
    assert len(volts) * rig.line.sample_time < seconds + 0.01


def still(rig: Rig, theta: float, number: int = 500) -> list[RigSample]:
    """Samples of a rig at rest."""
    body = EmulatedRig(rig, plant_of(rig, InitialState(phi=0.4, theta=theta)))
    body.firmware.session = 0
    reader, converter = FrameReader(), SampleConverter(rig)
    frames = [frame for _ in range(number) for frame in reader.read(body.step())]
    return [converter.convert(frame) for frame in frames if isinstance(frame, SensorsFrame)]


def test_zeros_are_found() -> None:
    """With the pendulum upright the codes at rest are the zeros; half a turn away if it hangs."""
    found = find_zeros(still(Rig(), 0.05), Rig(), hanging=False)
    assert found["arm.zero"] == 16
    assert found["pendulum.zero"] == pytest.approx(0.05 / (pi / 4 / 2048), abs=0.3)
    assert found["speed.zero"] == pytest.approx(0.0, abs=0.3)
    rig = Rig(pendulum=PendulumSensor(sensor="encoder", counts_per_turn=2000, zero=7.0))
    found = find_zeros(still(rig, pi - 1e-3), rig, hanging=True)
    assert found["pendulum.zero"] % 2000 == pytest.approx(7.0, abs=0.6)


def test_zeros_of_moving_sensors_are_rejected() -> None:
    """As are those of a pendulum beyond its sensor's range, and of a driver without codes."""
    samples = still(Rig(), 0.0)
    moved = [
        sample._replace(codes=sample.codes._replace(arm=sample.codes.arm + k // 10))
        for k, sample in enumerate(samples)
        if sample.codes is not None
    ]
    with pytest.raises(RigError, match="arm moves"):
        find_zeros(moved, Rig(), hanging=False)
    with pytest.raises(RigError, match="end of its range"):
        find_zeros(still(Rig(), 2.0), Rig(), hanging=False)
    without_codes = [sample._replace(codes=None) for sample in samples]
    with pytest.raises(RigError, match="no raw codes"):
        find_zeros(without_codes, Rig(), hanging=False)
    assert np.ptp([sample.arm_angle for sample in samples]) == 0
