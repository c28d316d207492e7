"""The filter that estimates the pendulum's angle and speed, against scipy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import StateSpace, lsim

from furuta_control.estimation import MEMORY, EstimatorParameters, design_estimator, estimate_state
from furuta_control.estimators.lowpass import LowpassParameters
from furuta_model.sensors import Sensors


def estimates(measurements: np.ndarray, p: EstimatorParameters) -> np.ndarray:
    """Estimates (n, 5) for measurements (n, 5), from a filter without past."""
    memory, made = np.zeros(MEMORY), design_estimator(p)
    result = np.full_like(measurements, 99.0)
    for measurement, estimate in zip(measurements, result, strict=True):
        estimate_state(memory, measurement, made, estimate)
    return result


def of_theta(theta: np.ndarray) -> np.ndarray:
    """Measurements (n, 5) of the pendulum's angle, without speed as on the rig."""
    measurements = np.zeros((len(theta), 5))
    measurements[:, 2], measurements[:, 3] = theta, np.nan
    return measurements


@pytest.mark.parametrize("bandwidth", [2.0, 200.0, 2e4])
@pytest.mark.parametrize("damping", [0.3, 1.0, 3.0])
@pytest.mark.parametrize("dt", [1e-4, 1e-3, 0.02])
def test_filter_is_scipys(bandwidth: float, damping: float, dt: float) -> None:
    """Angle and speed are the states of ω²/(s² + 2ζωs + ω²), its input linear between samples."""
    a = [[0, 1], [-(bandwidth**2), -2 * damping * bandwidth]]
    system = StateSpace(a, [[0], [bandwidth**2]], np.eye(2), np.zeros((2, 1)))
    theta = np.cumsum(np.random.default_rng(10).normal(0, 0.01, 300)) + 0.3
    time = np.arange(300) * dt
    _, expected, _ = lsim(system, theta, time, X0=[theta[0], 0.0], interp=True)
    p = EstimatorParameters(
        "lowpass", lowpass=LowpassParameters(bandwidth, damping), sample_time=dt
    )
    found = estimates(of_theta(theta), p)[:, 2:]
    assert found[:, 0] == pytest.approx(expected[:, 0], abs=1e-9)
    assert found[:, 1] == pytest.approx(expected[:, 1], rel=1e-7, abs=1e-7 * np.ptp(theta) / dt)


def test_no_jump_at_the_start() -> None:
    """A pendulum that stands still is estimated so from the first sample on."""
    found = estimates(of_theta(np.full(500, 0.4)), EstimatorParameters("lowpass"))
    assert found[:, 2] == pytest.approx(0.4)
    assert found[:, 3] == pytest.approx(0.0, abs=1e-9)


def test_steady_ramp() -> None:
    """Of a ramp the speed is exact and the angle late by 2ζ/ω."""
    p = EstimatorParameters("lowpass")
    time = np.arange(500) * p.sample_time
    found = estimates(of_theta(1.5 * time), p)[-1]
    assert found[3] == pytest.approx(1.5, rel=1e-9)
    assert found[2] == pytest.approx(1.5 * (time[-1] - 2 * 0.7 / 200), rel=1e-9)


def test_lowpass_takes_the_arm_as_measured() -> None:
    """Arm angle and speed go through unchanged; of the friction it knows nothing."""
    measurements = np.random.default_rng(11).normal(size=(20, 5))
    found = estimates(measurements, EstimatorParameters("lowpass"))
    assert np.array_equal(found[:, :2], measurements[:, :2])
    assert np.all(np.isnan(found[:, 4]))


@pytest.mark.parametrize("method", ["kalman", "lowpass"])
def test_ideal_sensors_need_no_estimate(method: str) -> None:
    """With all states measured exactly the estimate is the measurement."""
    measurements = np.random.default_rng(12).normal(size=(20, 5))
    found = estimates(measurements, EstimatorParameters(method, sensors=Sensors(ideal=True)))
    assert np.array_equal(found[:, :4], measurements[:, :4])


@pytest.mark.parametrize("methods", [("kalman", "lowpass"), ("lowpass", "kalman")])
def test_a_change_of_method_begins_at_the_last_estimate(methods: tuple[str, str]) -> None:
    """No jump beyond what the two methods differ by; begun afresh, the speed would drop to 0."""
    time = np.arange(400) * 1e-3
    theta = 0.1 * np.sin(5.0 * time)
    before, after = (design_estimator(EstimatorParameters(each)) for each in methods)
    memory, found = np.zeros(MEMORY), np.zeros((400, 5))
    for k, measurement in enumerate(of_theta(theta)):
        estimate_state(memory, measurement, before if k < 200 else after, found[k])
    jump = np.abs(found[200, 2:4] - found[199, 2:4])
    assert jump[0] < 0.003
    assert jump[1] < 0.02
    assert abs(found[199, 3]) > 0.25
