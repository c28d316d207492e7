"""Random walks of a rig with faults, and of the systems that ``proofs`` explores.

``make soak`` walks longer.
"""

from collections.abc import Iterator
from unittest.mock import patch

import pytest
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule
from proofs import arming_world, lockstep_world
from soak_settings import run

from furuta_hw.bridge import guarded_rig
from furuta_hw.bridge.guarded_rig import GuardedRig
from furuta_hw.connection import rig_connection
from furuta_hw.connection.rig_connection import RigConnection
from furuta_hw.drivers import make_driver
from furuta_hw.drivers.serial_protocol import driver
from furuta_hw.emulator import emulated_rig
from furuta_hw.emulator.emulated_rig import EmulatedRig
from furuta_hw.emulator.faults import Faults
from furuta_hw.guard import Guard
from furuta_hw.rigs.calibration import PendulumSensor, SpeedSensor
from furuta_hw.rigs.rig import Rig, SafetyLimits

# Encoders, and limits that a falling pendulum does not exceed: only faults stop this rig.
RIG = Rig(
    speed=SpeedSensor(sensor="encoder"),
    pendulum=PendulumSensor(sensor="encoder"),
    limits=SafetyLimits(pendulum_angle=6.0, arm_angle=1e6, arm_speed=1e4, disagreement=1e3),
)
# Samples after which a rig without faults can be armed again, and after which it is held upright.
SETTLED, HELD = 3000, 500
FAULTS = (
    Faults(),
    *(Faults(**{name: share}) for name in ("lost", "repeated", "corrupt") for share in (0.02, 0.6)),
    *(Faults(late=samples) for samples in (1, 10, 45, 300)),
    *(Faults(**{name: True}) for name in ("silent", "rig_fault")),
    Faults(0.02, 0.5, 0.02, 5),
)


class Clock:
    """The time [s] of this computer, which passes while it sleeps."""

    now = 0.0

    def monotonic(self) -> float:
        """The time [s]."""
        return self.now

    def sleep(self, seconds: float) -> None:
        """Let time pass."""
        self.now += seconds


CLOCK = Clock()


class Connection(RigConnection):
    """A connection that reads in the thread of the test, one sample at a time."""

    def _start_reading(self) -> None: ...

    def samples(self) -> list:
        """The samples of the next period."""
        if self.connected:
            self._inbox.append(self._driver.read())
        else:
            CLOCK.sleep(RIG.line.sample_time)
        return super().samples()


class DrivenRig(RuleBasedStateMachine):
    """A bridge drives an emulated rig, whose line and sensors fail."""

    def __init__(self) -> None:
        super().__init__()
        self.connection = Connection(make_driver("mock", RIG), lambda: None)
        self.connection.open()
        self.guard = Guard(RIG.limits, RIG.line.sample_time)
        self.bridge = GuardedRig(self.connection, self.guard, lambda: None)
        self.volts, self.is_answering = 1.0, True
        self.unarmed = 0  # samples since the guard was armed
        self.has_recovered = False

    @property
    def rig(self) -> EmulatedRig:
        """The emulated rig; the mock is a new one after the line was opened again."""
        return self.connection._driver._port._rig

    @rule(count=st.integers(1, 100))
    def samples(self, count: int) -> None:
        """So many periods, in which the graph answers each sample, unless it is paused."""
        for _ in range(count):
            for _ in self.bridge.samples():
                if self.is_answering:
                    self.guard.estimated()
                    self.bridge.command(self.volts)
            self.bridge.check()
            self.unarmed = 0 if self.guard.armed else self.unarmed + 1
            self.is_safe()

    @invariant()
    def is_safe(self) -> None:
        """0 V within the watchdog after the last answer, and after the guard was armed."""
        firmware = self.rig.firmware
        if self.rig.drive_volts != 0.0:
            assert (firmware.number - firmware.answered) % 2**32 < RIG.watchdog_samples
            assert self.unarmed <= RIG.watchdog_samples
            assert abs(self.rig.drive_volts) <= RIG.limits.voltage

    @rule(faults=st.sampled_from(FAULTS))
    def fail(self, faults: Faults) -> None:
        """Line and sensors have these faults from now on."""
        self.rig.faults = faults

    @rule(answering=st.booleans(), volts=st.floats(-20.0, 20.0) | st.just(float("nan")))
    def control(self, answering: bool, volts: float) -> None:
        """The graph pauses, or sends another command."""
        self.is_answering, self.volts = answering, volts

    @rule()
    def arm(self) -> None:
        """A user arms."""
        if not self.bridge.arm():
            self.unarmed = 0

    @rule()
    def disarm(self) -> None:
        """A user disarms."""
        self.bridge.stop("disarmed by request")

    @precondition(lambda self: not self.has_recovered)
    @rule()
    def recover(self) -> None:
        """Without faults it is armed and driven again; once per example, for it takes long."""
        self.has_recovered = True
        self.fail(Faults())
        self.control(True, 1.0)
        self.samples(SETTLED)
        self.rig.hold()
        self.samples(HELD)
        self.bridge.arm()
        self.samples(10)
        assert self.guard.armed, self.guard.reason
        assert self.rig.drive_volts > 0.0


class Walk(RuleBasedStateMachine):
    """Goes a random way through a system of ``proofs``."""

    def __init__(self, system, state) -> None:
        super().__init__()
        self.system, self.state = system, state

    @rule(numbers=st.lists(st.integers(0, 10**6), min_size=1, max_size=50))
    def walk(self, numbers: list[int]) -> None:
        """Some steps, each one of those that are possible."""
        for number in numbers:
            following = list(self.system.steps(self.state))
            if not following:
                return
            _, self.state = following[number % len(following)]
            assert not self.state.problem


@pytest.fixture
def own_time() -> Iterator[None]:
    """The rig, its line and the bridge have the time of the test."""
    with (
        patch.multiple(emulated_rig, monotonic=CLOCK.monotonic, sleep=CLOCK.sleep),
        patch.object(driver, "monotonic", CLOCK.monotonic),
        patch.object(rig_connection, "monotonic", CLOCK.monotonic),
        patch.object(guarded_rig, "monotonic", CLOCK.monotonic),
    ):
        yield


def test_a_rig_is_driven_only_while_it_is_guarded(own_time: None) -> None:
    """Whatever fails; and it is armed again afterwards."""
    run(DrivenRig)


LOCKSTEP = lockstep_world.Bounds(1000, 1000, 1000, 1000, 1000)
ARMING = arming_world.Budget(*[1000] * 6)


def test_lockstep_far_beyond_the_bounds_of_the_proof() -> None:
    """Each command answers its own sample."""
    with lockstep_world.own_clock():
        run(lambda: Walk(lockstep_world, lockstep_world.World(LOCKSTEP)))


def test_arming_far_beyond_the_bounds_of_the_proof() -> None:
    """Nothing is armed unasked."""
    with arming_world.own_clock():
        run(lambda: Walk(arming_world, arming_world.Rig(ARMING)))
