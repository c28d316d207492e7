"""Servos of which only goal and position are logged."""

import numpy as np
import pytest
from true_axes import TrueAxis, advanced

from furuta.identification.bodies.servo import identify_servo
from furuta_model.compiled import compiled
from furuta_model.parameters import ParameterError
from furuta_recordings.recording import Recording


@compiled
def _move(
    a: TrueAxis, limit: float, goal: np.ndarray, interval: float, steps: int, out: np.ndarray
) -> None:
    h, q, v = interval / steps, 0.0, 0.0
    late = round(a.delay / h)
    for i in range(len(goal)):
        out[i] = q
        for step in range(steps):
            k = max(int(np.floor((i * steps + step - late) / steps)), 0)
            pull = min(max(goal[k] - q - 0.5 * h * v, -limit), limit)
            q, v = advanced(a, q, v, pull, 0.0, h)


def random_servo(seed: int) -> tuple[dict[str, float], Recording]:
    """A random servo in units of its loop's stiffness, and a recording at 200 Hz of 20 s."""
    r = np.random.default_rng(500 + seed)
    inertia, step = 10.0 ** r.uniform(-3.5, -2.5), 1.0 / (200.0 * 200.0)
    axis = TrueAxis(
        inertia,
        10.0 ** r.uniform(-2.2, -1.2),
        2.0 * np.sqrt(inertia) * r.uniform(0.4, 1.2),
        offset=r.uniform(-0.02, 0.02),
        delay=round(r.uniform(0.0, 0.02) / step) * step,
    )
    time = np.arange(4000) / 200.0
    goal = 0.5 * np.sin(2.0 * np.pi * r.uniform(0.1, 0.4) * time)
    goal += 0.3 * np.sign(np.sin(2.0 * np.pi * r.uniform(0.2, 0.6) * time))
    out, limit = np.empty(len(time)), r.uniform(0.15, 0.4)
    _move(axis, limit, goal, 1.0 / 200.0, 200, out)
    measured = np.full((len(time), 4), np.nan)
    measured[:, 0] = 2.0 * np.pi / 4096.0 * np.round(out * 4096.0 / (2.0 * np.pi))
    truth = {
        "inertia": inertia,
        "friction": axis.alpha0,
        "viscous": axis.viscous,
        "delay": axis.delay,
        "limit": limit,
        "offset": axis.offset,
    }
    return truth, Recording("servo", time, measured, time, goal)


@pytest.mark.parametrize("seed", range(3))
def test_servos_are_found(seed: int) -> None:
    """Inertia, friction, delay and the limit of the supply, in units of the loop's stiffness."""
    truth, recording = random_servo(seed)
    fit = identify_servo(recording)
    assert fit.usable == "yes"
    assert {"inertia", "friction", "limit"} <= set(fit.values)
    for name, value in fit.values.items():
        assert abs(value - truth[name]) < max(4.0 * fit.standard_errors[name], 1e-2 * truth[name])


def test_a_limit_that_is_not_reached_is_not_determined() -> None:
    """Small steps tell a lower bound only; a goal of the other sign is refused."""
    _, recording = random_servo(0)
    slow = recording._replace(command=0.1 * np.sin(recording.time))
    out = np.empty(len(slow.time))
    _move(TrueAxis(1e-3, 0.01, 0.05), 1.0, slow.command, 1.0 / 200.0, 200, out)
    measured = slow.measured.copy()
    measured[:, 0] = 2.0 * np.pi / 4096.0 * np.round(out * 4096.0 / (2.0 * np.pi))
    fit = identify_servo(slow._replace(measured=measured))
    assert "limit" in fit.undetermined
    with pytest.raises(ParameterError, match="does not follow its goal"):
        identify_servo(recording._replace(command=-recording.command))
