"""The observer of the friction in the present, on the linear model with exact states."""

from math import exp, nan

import numpy as np
import pytest
from scipy import signal
from scipy.linalg import expm

from furuta_friction.compensation import (
    CompensationMemory,
    ObserverParameters,
    design_compensator,
    estimate_friction,
    pass_missing,
)
from furuta_friction.disturbance_observer import Body, ObservationMemory, design, observe
from furuta_model.block import new_memory
from furuta_model.friction.parameters import Friction
from furuta_model.late_drive import LateDrive
from furuta_model.linear import DesiredPoles, linearize, place_poles
from furuta_model.pendulum import FurutaPendulum

DT = 1e-3
A, B = linearize(FurutaPendulum())
STEP = expm(np.block([[A, B[:, None]], [np.zeros((1, 5))]]) * DT)
FEEDBACK = place_poles(FurutaPendulum(), DesiredPoles())
ON_TIME, LATE = LateDrive(), LateDrive(10, 0.015)


def observed(
    friction: np.ndarray, known: LateDrive = ON_TIME, true: LateDrive = ON_TIME, k: float = 50.0
) -> np.ndarray:
    """What is observed [V] of a friction (n,) on a balanced arm whose voltage also jumps."""
    p = design(Body(A, B, known, DT), k, 2.0, 0.2, acts=False)
    memory, x, u = new_memory(ObservationMemory)[0], np.zeros(4), 0.0
    on_its_way, torque = [0.0] * true.delay, 0.0
    share = 1.0 - exp(-DT / true.lag) if true.lag else 1.0
    mean_share = 1.0 - share * true.lag / DT if true.lag else 1.0
    found = []
    for sample, force in enumerate(friction):
        found.append(observe(memory, np.append(x, u), p))
        u = float(-FEEDBACK @ x) + (0.3 if sample // 150 % 2 else -0.3)
        on_its_way.append(u)
        step = on_its_way.pop(0) - torque
        mean = torque + mean_share * step
        torque += share * step
        x = STEP[:4, :4] @ x + STEP[:4, 4] * (mean - force)
    return np.array(found)


@pytest.mark.parametrize("drive", [ON_TIME, LATE])
def test_a_constant_friction_is_found(drive: LateDrive) -> None:
    """To a percent, whatever the voltage does, also behind a late drive that is known."""
    found = observed(np.full(2000, 0.2), drive, drive)
    assert found[500:] == pytest.approx(0.2, abs=0.002)


def test_a_late_drive_that_is_not_known_is_taken_for_friction() -> None:
    found = observed(np.full(2000, 0.2), true=LATE)
    assert np.max(np.abs(found[500:] - 0.2)) > 0.05
    assert np.mean(found[500:]) == pytest.approx(0.2, abs=0.01)


@pytest.mark.parametrize("bandwidth", [25.0, 50.0, 100.0])
def test_a_step_is_followed_with_the_bandwidth(bandwidth: float) -> None:
    """As by the transfer function L/(1 + L) with L = (ks + 0.7k²)/s² · 3k/(s + 3k)."""
    numerator = 3.0 * bandwidth * np.array([bandwidth, 0.7 * bandwidth**2])
    denominator = np.polyadd([1.0, 3.0 * bandwidth, 0.0, 0.0], numerator)
    times = DT * np.arange(300)
    _, expected = signal.step((numerator, denominator), T=times)
    found = (observed(np.repeat([-0.2, 0.2], 1000), k=bandwidth)[1000:1300] + 0.2) / 0.4
    # Within two thirds of a sample of the fastest change.
    assert found == pytest.approx(expected, abs=bandwidth * DT)


def test_what_is_modelled_is_not_observed() -> None:
    """The rest is what the friction has beyond the model in the torque."""
    p, memory = (
        design(Body(A, B, ON_TIME, DT), 50.0, 2.0, 0.2, acts=True),
        new_memory(ObservationMemory)[0],
    )
    x, rest = np.zeros(4), 0.0
    for _ in range(2000):
        u = float(-FEEDBACK @ x) + 0.15 + rest
        memory["modelled_sent"] = 0.15
        rest = observe(memory, np.append(x, u), p)
        x = STEP[:4, :4] @ x + STEP[:4, 4] * (u - 0.2)
    assert rest == pytest.approx(0.05, abs=1e-3)


@pytest.mark.parametrize(
    "x", [[0.0, 0.1, 0.8, 0.0, 0.0], [0.0, 0.1, 0.0, nan, 0.0], [0.0] * 4 + [nan]]
)
def test_it_begins_anew_where_the_model_does_not_hold(x: list[float]) -> None:
    """Far from upright, and where speed or torque are not known, nothing is observed."""
    p = design(Body(A, B, ON_TIME, DT), 50.0, 2.0, 0.2, acts=False)
    memory, upright = new_memory(ObservationMemory)[0], np.array([0.0, 0.1, 0.01, 0.0, 0.3])
    first = [observe(memory, upright, p) for _ in range(50)]
    assert np.isnan(observe(memory, np.array(x), p))
    assert [observe(memory, upright, p) for _ in range(50)] == first


def test_a_vibration_reduces_the_bandwidth() -> None:
    """Beyond what the friction explains; only where what is observed acts."""
    parts = []
    for acts, amplitude in ((True, 2.0), (True, 0.02), (False, 2.0)):
        p, memory = (
            design(Body(A, B, ON_TIME, DT), 50.0, 2.0, 0.2, acts),
            new_memory(ObservationMemory)[0],
        )
        for k in range(2000):
            v = amplitude * np.sin(2.0 * np.pi * 25.0 * DT * k)
            observe(memory, np.array([0.0, v, 0.0, 0.0, 0.0]), p)
        parts.append(float(memory["vibration"]["part"]))
    assert parts[0] < 0.1
    assert parts[1] > 0.24
    assert parts[2] == 1.0


@pytest.mark.parametrize("kind", ["recommended", "stiction"])
def test_samples_that_are_left_out_are_passed(kind: str) -> None:
    """F̂ of a constant friction is as good if two of three samples are left out."""

    def error(every: int) -> float:
        p = design_compensator(ObserverParameters(kind, Friction(stribeck_velocity=100.0)))
        memory, x, u, errors = new_memory(CompensationMemory)[0], np.zeros(4), 0.0, []
        for sample in range(0, 3000, every):
            for _ in range(every - 1 if sample else 0):
                pass_missing(memory, np.append(x, u), p)
            estimate = estimate_friction(memory, np.append(x, u), p)
            u = float(-FEEDBACK @ x) + (0.3 if sample // 150 % 2 else -0.3) + estimate
            errors.append(estimate - 0.2)
            for _ in range(every):
                x = STEP[:4, :4] @ x + STEP[:4, 4] * (u - 0.2)
        return float(np.sqrt(np.mean(np.square(errors[300:]))))

    assert error(3) < 1.2 * error(1) + 0.02
