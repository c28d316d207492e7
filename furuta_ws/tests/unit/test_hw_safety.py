"""The guard: nothing passes that should not, and every reason to stop stops."""

from __future__ import annotations

from math import inf, nan

import numpy as np
import pytest

from furuta_hw.frames import ARMED, FAULT, WATCHDOG
from furuta_hw.rig import Limits
from furuta_hw.safety import Guard

DT = 0.001


class Rig:
    """A guard with a rig that is well, until it is not."""

    def __init__(self, **limits: float) -> None:
        self.guard = Guard(Limits(**limits), DT)
        self.now = 100.0
        self.observed = True
        self.x = np.array((0.1, 0.0, 0.02, nan, 0.0))
        self.measure(status=0)
        self.guard.command(self.now, 0.0)

    def measure(self, at_rail: bool = False, status: int = ARMED, steps: int = 1) -> None:
        """A measurement, with the observer's answer."""
        self.now += steps * DT
        self.guard.measured(self.now, self.x, at_rail, status, steps)
        if self.observed:
            self.guard.estimated()

    def sample(self, u: float = 0.0, **given: int) -> float | None:
        """A measurement and a command."""
        self.measure(**given)
        return self.guard.command(self.now, u)


def armed(**limits: float) -> Rig:
    """An armed guard whose rig says so."""
    rig = Rig(**limits)
    assert rig.guard.arm(rig.now) == ""
    assert rig.sample() == 0.0
    return rig


def test_nothing_passes_before_arming() -> None:
    """A command is heard, not obeyed."""
    rig = Rig()
    assert rig.sample(1.0, status=0) is None
    assert rig.guard.reason == "not armed yet"


def test_commands_are_limited_in_size_and_slew() -> None:
    """From 0 V by at most the slew rate, to at most the largest voltage."""
    rig = armed(voltage=3.0, slew_rate=1000.0)
    assert [rig.sample(8.0) for _ in range(5)] == [1.0, 2.0, 3.0, 3.0, 3.0]
    assert rig.sample(-8.0) == 2.0
    assert rig.sample(1.5) == 1.5


@pytest.mark.parametrize("bad", [nan, inf, -inf])
def test_a_command_that_is_no_number_stops(bad: float) -> None:
    """NaN and infinities."""
    rig = armed()
    assert rig.guard.command(rig.now, bad) is None
    assert not rig.guard.armed
    assert "command is" in rig.guard.reason


@pytest.mark.parametrize(
    ("index", "value", "reason"),
    [
        (2, 0.76, "pendulum angle 0.760 rad is beyond 0.75 rad"),
        (2, -0.76, "pendulum angle"),
        (0, 7.0, "arm angle"),
        (1, -9.95, "arm speed"),
        (0, nan, "not finite"),
        (2, inf, "not finite"),
    ],
)
def test_a_measurement_out_of_bounds_stops(index: int, value: float, reason: str) -> None:
    """At once, and the rig cannot be armed while it lasts."""
    rig = armed()
    rig.x[index] = value
    rig.measure()
    assert not rig.guard.armed
    assert reason in rig.guard.reason
    assert reason in rig.guard.arm(rig.now)


def test_a_sensor_at_its_end_stops() -> None:
    """Beyond its range a converter tells nothing."""
    rig = armed()
    rig.measure(at_rail=True)
    assert "end of its range" in rig.guard.reason


def test_stale_commands_and_measurements_stop() -> None:
    """Each at its own age, seen without anything arriving."""
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


def test_a_missing_observer_stops() -> None:
    """Commands alone do not do: the loop is whole, or at 0 V."""
    rig = armed(estimate_age=0.03)
    rig.observed = False
    assert [rig.sample() for _ in range(30)] == [0.0] + [None] * 29
    assert rig.guard.armed
    rig.measure()
    assert rig.sample() is None
    assert "no friction estimate for 0.03 s" in rig.guard.reason


def test_a_bad_line_stops_beyond_its_limit() -> None:
    """Five frames of a hundred bad is borne, twenty is not."""
    rig = armed(bad_frames=0.1)
    for k in range(3000):
        rig.guard.line(k % 20 == 0)
        rig.sample()
    assert rig.guard.armed
    for k in range(1000):
        rig.guard.line(k % 5 == 0)
        rig.sample()
    assert "lost or corrupt" in rig.guard.reason


def test_an_encoder_that_is_stuck_stops() -> None:
    """The tachometer says that the arm moves, the encoder that it does not."""
    rig = armed(disagreement=0.3)
    rig.x[1] = 1.0
    for _ in range(2000):
        rig.sample()
    assert "disagree" in rig.guard.reason
    rig = armed(disagreement=0.3)
    rig.x[1] = 1.0
    for _ in range(2000):
        rig.x[0] += DT
        rig.sample()
    assert rig.guard.armed


@pytest.mark.parametrize(
    ("status", "reason"),
    [(WATCHDOG, "watchdog"), (0, "the rig stopped"), (FAULT, "reports a fault")],
)
def test_a_rig_that_stops_by_itself_is_believed(status: int, reason: str) -> None:
    """Armed by us and once obeying, it no longer is."""
    rig = armed()
    rig.measure(status=status)
    assert reason in rig.guard.reason


def test_a_rig_that_does_not_arm_is_given_up() -> None:
    """Frames under way say "not armed" for a moment; for longer than that it is one."""
    rig = Rig()
    rig.guard.arm(rig.now)
    for _ in range(10):
        rig.sample(status=WATCHDOG)
    assert rig.guard.armed
    for _ in range(100):
        rig.sample(status=WATCHDOG)
    assert rig.guard.reason == "the rig did not arm"


def test_a_stop_is_latched_with_its_first_reason() -> None:
    """What comes after does not change it; only arming ends it, from 0 V."""
    rig = armed()
    rig.sample(1.0)
    rig.guard.stop("first")
    rig.guard.stop("second")
    assert (rig.guard.reason, rig.guard.stops) == ("first", 1)
    assert rig.sample(1.0, status=0) is None
    assert rig.guard.arm(rig.now) == ""
    assert rig.sample(0.5) == 0.5


def test_commands_without_estimates_are_kept_back() -> None:
    """One may overtake its estimate; further ones do not feed the rig's watchdog."""
    rig = armed()
    rig.observed = False
    assert [rig.sample(0.1) is None for _ in range(4)] == [False, True, True, True]
    rig.observed = True
    assert rig.sample(0.1) is not None
