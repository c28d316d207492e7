"""The Kalman filter, compared with the textbook recursion, and on the simulated rig."""

from math import nan, pi

import numpy as np
import pytest
from estimator_steps import estimates
from scipy.integrate import solve_ivp

from furuta_control.estimation import EstimatorParameters
from furuta_friction.compensation import ObserverParameters
from furuta_model.sensors import Sensors
from furuta_sim.parameters import PlantParameters
from furuta_sim.simulation.closed_loop import Loop, simulate

# The identified linear model of the paper, with the friction as a fifth state.
SYSTEM = np.array(
    [
        [0, 1, 0, 0, 0],
        [0, 0, -11, 0, -45],
        [0, 0, 0, 1, 0],
        [0, 0, 33, 0, 29],
        [0, 0, 0, 0, 0],
    ],
    dtype=float,
)
TORQUE = np.array([0, 45, 0, -29, 0], dtype=float)


def sampled(dt: float, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Transition, input and noise covariance by integration of their differential equations."""
    size = len(SYSTEM)

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        phi, g, p = y[: size**2].reshape(size, size), y[25:30], y[30:].reshape(size, size)
        return np.concatenate(
            [
                (SYSTEM @ phi).ravel(),
                SYSTEM @ g + TORQUE,
                (SYSTEM @ p + p @ SYSTEM.T + q).ravel(),
            ]
        )

    start = np.concatenate([np.eye(size).ravel(), np.zeros(5 + size**2)])
    end = solve_ivp(rate, (0, dt), start, rtol=1e-12, atol=1e-16, method="DOP853").y[:, -1]
    return end[:25].reshape(5, 5), end[25:30], end[30:].reshape(5, 5)


def test_agrees_with_the_textbook_filter() -> None:
    """The gain is the limit of the covariance recursion; estimates as by predict and correct."""
    dt, sensors = 1e-3, Sensors(encoder_counts=0)
    p = EstimatorParameters(sensors=sensors, sample_time=dt)
    noise = np.diag(
        [
            sensors.tachometer_noise**2 + (20 / 4096) ** 2 / 12,
            sensors.potentiometer_noise**2 + (pi / 2 / 4096) ** 2 / 12,
        ]
    )
    q = np.diag([0, 0, 0, 0.1**2, 0.3**2])
    transition, torque, spread = sampled(dt, q)
    reads = np.zeros((2, 5))
    reads[0, 1] = reads[1, 2] = 1.0
    # φ is not part of the filter: no other state or output depends on it.
    part = np.ix_(range(1, 5), range(1, 5))
    covariance = np.eye(4)
    for _ in range(round(20 / dt)):
        predicted = transition[part] @ covariance @ transition[part].T + spread[part]
        innovation = reads[:, 1:] @ predicted @ reads[:, 1:].T + noise
        gain = predicted @ reads[:, 1:].T @ np.linalg.inv(innovation)
        covariance = (np.eye(4) - gain @ reads[:, 1:]) @ predicted

    measurements = np.random.default_rng(3).normal(0, 0.03, (50, 5))
    measurements[:, 3] = nan
    found, _ = estimates(measurements, p)
    state = np.array([*measurements[0, :3], 0.0, 0.0])
    for measurement, estimate in zip(measurements[1:], found[1:], strict=True):
        state = transition @ state + torque * measurement[4]
        state[1:] += gain @ (measurement[1:3] - state[1:3])
        state[0] = measurement[0]
        assert estimate[:4] == pytest.approx(state[:4], rel=1e-6, abs=1e-9)
        assert estimate[4] == measurement[4]


def test_angle_stays_within_the_count_and_is_better_than_it() -> None:
    """φ̂ is within half a count of the encoder, and mostly far more accurate."""
    loop = Loop(PlantParameters(seed=5), observer=ObserverParameters("coulomb"))
    record = simulate(loop, 30.0)
    count = 2 * pi / 250
    error = record.estimate[:, 0] - record.state[:, 0]
    assert np.max(np.abs(error)) <= count * (1 + 1e-9)
    reading = np.round(record.state[:, 0] / count) * count
    assert np.max(np.abs(record.estimate[:, 0] - reading)) <= count / 2 * (1 + 1e-9)
    assert np.std(error[10_000:]) < 0.5 * np.std((reading - record.state[:, 0])[10_000:])


def test_improves_on_the_lowpass() -> None:
    """In the limit cycle the speeds have half the error of the low-pass."""
    errors = {}
    for method in ("kalman", "lowpass"):
        record = simulate(Loop(PlantParameters(seed=6), EstimatorParameters(method)), 30.0)
        settled = slice(10_000, None)
        errors[method] = np.std((record.estimate[:, :4] - record.state)[settled], axis=0)
    assert errors["kalman"][1] < 0.7 * errors["lowpass"][1]
    assert errors["kalman"][2] < 0.5 * errors["lowpass"][2]
    assert errors["kalman"][3] < 0.5 * errors["lowpass"][3]
