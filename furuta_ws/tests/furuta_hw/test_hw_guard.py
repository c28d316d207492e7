"""The guard: it limits commands, and every reason for a stop stops the rig."""

from math import inf, nan
from typing import Any

import pytest

from furuta_hw.connection.rig_driver import RigSample
from furuta_hw.guard import Guard
from furuta_hw.rigs.rig import SafetyLimits

DT = 0.001


class GuardedRig:
    """A guard with a rig that has no problem at first."""

    def __init__(self, **limits: float) -> None:
        self.guard = Guard(SafetyLimits(**limits), DT)
        self.now = 100.0
        self.with_observer = True
        self.next = RigSample(0, 0.1, 0.0, 0.02, 0.0, armed=True)
        self.measure(armed=False)
        self.guard.command(self.now, 0.0)

    def measure(self, steps: int = 1, **changes: Any) -> None:
        """A measurement ``steps`` samples after the last, and the observer's answer."""
        self.now += steps * DT
        self.next = self.next._replace(number=self.next.number + steps)
        self.guard.measured(self.now, self.next._replace(**changes))
        if self.with_observer:
            self.guard.estimated()

    def sample(self, u: float = 0.0, **given: Any) -> float | None:
        """A measurement and a command."""
        self.measure(**given)
        return self.guard.command(self.now, u)


def armed(**limits: float) -> GuardedRig:
    """Make an armed guard whose rig is armed too."""
    rig = GuardedRig(**limits)
    assert rig.guard.arm(rig.now) == ""
    assert rig.sample() == 0.0
    return rig


def test_nothing_passes_before_arming() -> None:
    """A command before arming is not applied."""
    rig = GuardedRig()
    assert rig.sample(1.0, armed=False) is None
    assert rig.guard.reason == "not armed yet"


def test_commands_are_limited_in_size_and_slew() -> None:
    """From 0 V by at most the slew rate, to at most the largest voltage; infinity stops."""
    rig = armed(voltage=3.0, slew_rate=1000.0)
    assert [rig.sample(8.0) for _ in range(5)] == [1.0, 2.0, 3.0, 3.0, 3.0]
    assert rig.sample(-8.0) == 2.0
    assert rig.sample(1.5) == 1.5
    assert rig.sample(inf) is None
    assert rig.guard.reason == "command is inf"


@pytest.mark.parametrize(
    ("field", "value", "reason"),
    [
        ("pendulum_angle", 0.76, "pendulum angle 0.760 rad is beyond 0.75 rad"),
        ("arm_angle", 7.0, "arm angle"),
        ("arm_speed", -9.95, "arm speed"),
        ("arm_angle", nan, "not finite"),
        ("at_rail", True, "end of its range"),
        ("fault", True, "reports a fault"),
    ],
)
def test_a_measurement_out_of_bounds_stops(field: str, value: Any, reason: str) -> None:
    """At once, and the rig cannot be armed with such a measurement."""
    rig = armed()
    rig.measure(**{field: value})
    assert not rig.guard.armed
    assert reason in rig.guard.reason
    assert reason in rig.guard.arm(rig.now)


def test_stale_commands_and_measurements_stop() -> None:
    """Each at its own age, also if nothing arrives."""
    rig = armed(command_age=0.02, measurement_age=0.03)
    for _ in range(19):
        rig.measure()
    assert rig.guard.armed
    rig.measure(steps=3)
    assert "no command for 0.02 s" in rig.guard.reason
    rig = armed(command_age=0.05, measurement_age=0.03)
    rig.guard.check(rig.now + 0.029)
    assert rig.guard.armed
    rig.guard.check(rig.now + 0.031)
    assert "no measurement for 0.03 s" in rig.guard.reason
    assert rig.guard.command(rig.now + 0.031, 1.0) is None


def test_a_missing_friction_observer_stops() -> None:
    """A command may overtake its estimate; further ones do not feed the rig's watchdog."""
    rig = armed(estimate_age=0.03)
    rig.with_observer = False
    assert [rig.sample(0.1) is None for _ in range(4)] == [False, True, True, True]
    rig.with_observer = True
    assert rig.sample(0.0) is not None
    rig.with_observer = False
    assert [rig.sample() for _ in range(30)] == [0.0] + [None] * 29
    assert rig.guard.armed
    rig.measure()
    assert rig.sample() is None
    assert "no friction estimate for 0.03 s" in rig.guard.reason


def test_a_bad_line_stops_beyond_its_limit() -> None:
    """Five bad frames in a hundred are accepted, twenty are not."""
    rig = armed(bad_frames=0.1)
    for k in range(3000):
        rig.guard.count_bad_frames(k % 20 == 0)
        rig.sample()
    assert rig.guard.armed
    for k in range(1000):
        rig.guard.count_bad_frames(k % 5 == 0)
        rig.sample()
    assert "lost or corrupt" in rig.guard.reason


def test_an_encoder_that_is_stuck_stops() -> None:
    """The arm moves according to the tachometer, and not according to the encoder."""
    rig = armed(disagreement=0.3)
    rig.next = rig.next._replace(arm_speed=1.0)
    for _ in range(2000):
        rig.sample()
    assert "disagree" in rig.guard.reason
    rig = armed(disagreement=0.3)
    rig.next = rig.next._replace(arm_speed=1.0)
    for _ in range(2000):
        rig.next = rig.next._replace(arm_angle=rig.next.arm_angle + DT)
        rig.sample()
    assert rig.guard.armed


@pytest.mark.parametrize("field", ["arm_angle", "arm_speed"])
@pytest.mark.parametrize("value", [nan, inf, -inf])
def test_an_encoder_that_is_stuck_stops_after_a_number_that_is_not_finite(
    field: str, value: float
) -> None:
    """The rig stops at that number, is armed again, and stops for the encoder."""
    rig = armed(disagreement=0.3)
    rig.sample(**{field: value})
    assert rig.guard.reason == "measurement is not finite"
    rig.sample()
    assert rig.guard.arm(rig.now) == ""
    rig.next = rig.next._replace(arm_speed=1.0)
    for _ in range(2000):
        rig.sample()
    assert "disagree" in rig.guard.reason


@pytest.mark.parametrize(("watchdog", "reason"), [(True, "watchdog"), (False, "the rig stopped")])
def test_a_rig_that_stopped_by_itself_stops_the_guard(watchdog: bool, reason: str) -> None:
    """The rig was armed and is not any more."""
    rig = armed()
    rig.measure(armed=False, watchdog=watchdog)
    assert reason in rig.guard.reason


def test_a_rig_that_does_not_arm_stops_the_guard() -> None:
    """Frames in transit report "not armed" for a moment only."""
    rig = GuardedRig()
    rig.guard.arm(rig.now)
    for _ in range(10):
        rig.sample(armed=False, watchdog=True)
    assert rig.guard.armed
    for _ in range(100):
        rig.sample(armed=False, watchdog=True)
    assert rig.guard.reason == "the rig did not arm"


def test_a_stop_is_latched_with_its_first_reason() -> None:
    """Later reasons do not change it; only arming ends it, from 0 V."""
    rig = armed()
    rig.sample(1.0)
    rig.guard.stop("first")
    rig.guard.stop("second")
    assert (rig.guard.reason, rig.guard.stops) == ("first", 1)
    assert rig.sample(1.0, armed=False) is None
    assert rig.guard.arm(rig.now) == ""
    assert rig.sample(0.5) == 0.5
