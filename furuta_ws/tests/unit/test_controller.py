"""State feedback: sign convention, limits, and when it gives up."""

from __future__ import annotations

import numpy as np
import pytest
from unit import reference

from furuta_control.controller import control, state_feedback
from furuta_control.parameters import ControllerParameters
from furuta_model.pendulum import FurutaPendulum

GAIN = (-1.0, -2.0, -30.0, -4.0)
RNG = np.random.default_rng(13)


def command(x: list[float] | np.ndarray, friction: float = 0.0, **parameters: object) -> float:
    """U of a controller that holds the pendulum."""
    feedback = state_feedback(ControllerParameters(**{"gain": GAIN} | parameters))
    return control(np.ones(1), np.array(x, dtype=float), friction, feedback)


def test_feedback_is_minus_lx() -> None:
    """Inside the limits u = −Lx + F̂."""
    for x in RNG.uniform(-0.1, 0.1, (50, 4)):
        friction = RNG.uniform(-1, 1)
        assert command(x, friction) == pytest.approx(-np.dot(GAIN, x) + friction)


def test_exact_estimate_cancels_friction() -> None:
    """With F̂ = F the arm accelerates as without friction; with the printed minus it doubles."""
    body = FurutaPendulum()
    for x in RNG.uniform(-0.1, 0.1, (50, 4)):
        _, v, theta, w = x
        friction = np.sign(v) * 0.21  # opposes the motion on the right side of (1), u − F
        free = reference.accelerations(v, theta, w, command(x), body)
        compensated = command(x, friction) - friction
        assert reference.accelerations(v, theta, w, compensated, body) == pytest.approx(free)
        slowed = reference.accelerations(v, theta, w, command(x, -friction) - friction, body)
        assert (slowed - free)[0] * np.sign(v) == pytest.approx(-2 * 45 * 0.21, rel=0.02)


def test_gain_from_the_poles() -> None:
    """Without explicit gain the poles on the nominal model decide: here those of the paper."""
    l1, l2, l3, l4 = state_feedback(ControllerParameters())[:4]
    a = np.array([[0, 1, 0, 0], [0, 0, -11, 0], [0, 0, 0, 1], [0, 0, 33, 0]])
    closed = a - np.outer([0, 45, 0, -29], [l1, l2, l3, l4])
    assert np.poly(closed) == pytest.approx([1, 16.8, 142.6, 588, 1225])
    assert state_feedback(ControllerParameters(gain=GAIN))[:4] == GAIN


@pytest.mark.parametrize("limit", [0.0, 2.5, 10.0])
def test_saturation(limit: float) -> None:
    """The command never exceeds the limit, friction estimate included, and keeps its sign."""
    for x in RNG.uniform(-1, 1, (50, 4)) * [50, 50, 0.19, 50]:
        friction = RNG.uniform(-5, 5)
        expected = np.clip(-np.dot(GAIN, x) + friction, -limit, limit)
        assert command(x, friction, voltage_limit=limit) == pytest.approx(expected)


def test_disabled() -> None:
    """Not enabled it commands 0 V, whatever the state and the friction estimate."""
    assert command([1, 1, 0.1, 1], 0.2, enabled=False) == 0.0
    assert command([1, 1, 0.1, 1], 0.2) != 0.0


@pytest.mark.parametrize("side", [-1, 1])
def test_falls_and_catches(side: int) -> None:
    """Beyond fall_angle it lets go, and takes over again only within catch_angle."""
    feedback = state_feedback(
        ControllerParameters(gain=GAIN, fall_angle=0.7, catch_angle=0.2, voltage_limit=100.0)
    )
    memory = np.zeros(1)
    driven = [
        control(memory, np.array([0, 0, side * tilt, 0]), 0.1, feedback) != 0.0
        for tilt in (0.5, 0.21, 0.2, 0.5, 0.7, 0.71, 0.5, 0.21, 3.0, 0.0)
    ]
    assert driven == [False, False, True, True, True, False, False, False, False, True]


def test_disabled_controller_still_watches_the_pendulum() -> None:
    """A pendulum that fell while disabled is not driven when enabled in between."""
    memory = np.ones(1)
    disabled = state_feedback(ControllerParameters(gain=GAIN, enabled=False))
    enabled = state_feedback(ControllerParameters(gain=GAIN))
    control(memory, np.array([0, 0, 1.0, 0]), 0.0, disabled)
    assert control(memory, np.array([0, 0, 0.5, 0]), 0.0, enabled) == 0.0
