"""The low-pass estimator of the pendulum, compared with scipy."""

import numpy as np
import pytest
from estimator_steps import EstimatorSteps, estimates
from scipy.signal import StateSpace, lsim

from furuta_control.estimation import EstimatorParameters
from furuta_control.estimators.lowpass import LowpassParameters
from furuta_model.sensors import Sensors


def of_theta(theta: np.ndarray) -> np.ndarray:
    """Measurements (n, 5) of the pendulum angle, without its speed as on the rig."""
    measurements = np.zeros((len(theta), 5))
    measurements[:, 2], measurements[:, 3] = theta, np.nan
    return measurements


@pytest.mark.parametrize(
    ("bandwidth", "damping", "dt"), [(2.0, 0.3, 0.02), (200.0, 1.0, 1e-3), (2e4, 3.0, 1e-4)]
)
def test_filter_agrees_with_scipy(bandwidth: float, damping: float, dt: float) -> None:
    """Angle and speed are the states of ω²/(s² + 2ζωs + ω²) with linearly interpolated input."""
    a = [[0, 1], [-(bandwidth**2), -2 * damping * bandwidth]]
    system = StateSpace(a, [[0], [bandwidth**2]], np.eye(2), np.zeros((2, 1)))
    theta = np.cumsum(np.random.default_rng(10).normal(0, 0.01, 300)) + 0.3
    time = np.arange(300) * dt
    _, expected, _ = lsim(system, theta, time, X0=[theta[0], 0.0], interp=True)
    lowpass = LowpassParameters(bandwidth, damping)
    p = EstimatorParameters("lowpass", lowpass=lowpass, sample_time=dt)
    found = estimates(of_theta(theta), p)[0][:, 2:]
    assert found[:, 0] == pytest.approx(expected[:, 0], abs=1e-9)
    assert found[:, 1] == pytest.approx(expected[:, 1], rel=1e-7, abs=1e-7 * np.ptp(theta) / dt)


def test_lowpass_passes_the_arm_through() -> None:
    """Arm angle, arm speed and torque are unchanged."""
    measurements = np.random.default_rng(11).normal(0.0, 0.03, (20, 5))
    found, _ = estimates(measurements, EstimatorParameters("lowpass"))
    assert np.array_equal(found[:, :2], measurements[:, :2])
    assert np.array_equal(found[:, 4], measurements[:, 4])


@pytest.mark.parametrize("method", ["kalman", "lowpass"])
def test_ideal_measurements_are_not_filtered(method: str) -> None:
    """With ideal sensors the estimate is the measurement."""
    measurements = np.random.default_rng(12).normal(size=(20, 5))
    found, _ = estimates(measurements, EstimatorParameters(method, sensors=Sensors(ideal=True)))
    assert np.array_equal(found[:, :4], measurements[:, :4])


def test_new_method_starts_from_the_last_estimate() -> None:
    """No jump beyond the difference of the methods; a restart would set the speed to 0."""
    time = np.arange(400) * 1e-3
    theta = 0.1 * np.sin(5.0 * time)
    estimator = EstimatorSteps(EstimatorParameters("kalman"))
    before = [estimator.step(each)[0] for each in of_theta(theta)[:200]]
    estimator.design(EstimatorParameters("lowpass"))
    found = np.array([*before, *(estimator.step(each)[0] for each in of_theta(theta)[200:])])
    jump = np.abs(found[200, 2:4] - found[199, 2:4])
    assert jump[0] < 0.003
    assert jump[1] < 0.02
    assert abs(found[199, 3]) > 0.25
