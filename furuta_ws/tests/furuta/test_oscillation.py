"""Measurement of oscillations, on signals with known size and period."""

import numpy as np
import pytest

from furuta.oscillation import has_fallen, measure_oscillation

DT = 1e-3
TIME = np.arange(0, 30, DT)


def states(phi: np.ndarray, theta: np.ndarray | None = None) -> np.ndarray:
    """States (n, 4) with the arm speed by differences."""
    x = np.zeros((len(phi), 4))
    x[:, 0], x[:, 1] = phi, np.gradient(phi, DT)
    if theta is not None:
        x[:, 2] = theta
    return x


def test_sine_on_an_offset() -> None:
    """Peak to peak and period of sines are exact."""
    turn = 2 * np.pi * TIME / 2.3701 + 2.5
    found = measure_oscillation(states(5 + 0.25 * np.sin(turn), 0.04 * np.sin(turn) - 1), DT)
    assert found.phi_peak_to_peak_rad == pytest.approx(0.5, rel=1e-5)
    assert found.theta_peak_to_peak_rad == pytest.approx(0.08, rel=1e-5)
    assert found.period_s == pytest.approx(2.3701, rel=1e-6)


def test_period_with_a_rest_at_the_midpoint() -> None:
    """A noisy signal that rests at its midpoint has the period of its large motion."""
    turn = (TIME / 3.0) % 1
    signal = np.interp(turn, [0, 0.2, 0.4, 0.6, 0.8, 1.0], [0, 1, 0, 0, -1, 0])
    trembling = 0.02 * np.sin(2 * np.pi * TIME * 40)
    found = measure_oscillation(states(signal + trembling), DT)
    assert found.period_s == pytest.approx(3.0, rel=1e-2)


@pytest.mark.parametrize(
    "signal",
    [1e-7 * np.sin(TIME), TIME, np.sin(2 * np.pi * TIME[:1500])],
    ids=["too small", "drift", "one crossing"],
)
def test_no_period(signal: np.ndarray) -> None:
    """A signal with fewer than two crossings has no period."""
    assert np.isnan(measure_oscillation(states(signal), DT).period_s)


def test_stuck_fraction() -> None:
    """The fraction of time stuck is that of the plateaus."""
    turn = (TIME / 2.0) % 1
    phi = np.interp(turn, [0, 0.3, 0.5, 0.8, 1.0], [0, 0.4, 0.4, 0, 0])
    assert measure_oscillation(states(phi), DT).stuck_fraction == pytest.approx(0.4, abs=2e-3)


def test_fell() -> None:
    """Below the horizontal at any time, to either side, even if the pendulum came back."""
    theta = np.zeros(100)
    assert not has_fallen(states(theta, theta)).any()
    for tilt, expected in ((1.5, False), (-1.5, False), (1.6, True), (-1.6, True)):
        theta[50] = tilt
        assert has_fallen(states(np.zeros(100), theta)).any() == expected
