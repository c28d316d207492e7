"""The rig: converters, sensors, noise, and one sample of it."""

import math

import numpy as np
import pytest

from furuta_model.sensors import Actuator, convert, drive
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT
from furuta_sim.parameters import Sensors
from furuta_sim.plant import Noise, measure

QUIET = np.zeros(2)


def measured(x: list[float], noise: np.ndarray = QUIET, **sensors: object) -> np.ndarray:
    """One measurement (4,)."""
    measurement = np.full(4, 99.0)
    measure(np.array([*x, 0.0]), noise, Sensors(**sensors), measurement)
    return measurement


@pytest.mark.parametrize("bits", [1, 12, 32])
def test_codes_of_a_converter(bits: int) -> None:
    """Outputs are whole codes from −2ⁿ⁻¹ to 2ⁿ⁻¹ − 1, within half a code of the input."""
    full_scale = math.pi / 4
    code = 2 * full_scale / 2**bits
    for value in np.random.default_rng(7).uniform(-full_scale, full_scale - code, 200):
        output = convert(value, full_scale, bits)
        assert output / code == pytest.approx(round(output / code), abs=1e-6)
        assert abs(output - value) <= code / 2 * (1 + 1e-9)
        assert convert(output, full_scale, bits) == output
    for far in (1e3, 1e30, math.inf):  # keeps its sign
        assert convert(far, full_scale, bits) == pytest.approx(full_scale - code)
        assert convert(-far, full_scale, bits) == pytest.approx(-full_scale)


def test_drive_of_the_rig() -> None:
    """±10 V in 4096 steps of 4.88 mV, 0 exactly 0."""
    actuator = Actuator()
    outputs = {drive(u, actuator) for u in np.arange(-11, 11, 0.002)}
    assert len(outputs) == 4096
    assert np.diff(sorted(outputs)) == pytest.approx(20 / 4096)
    assert drive(0.0, actuator) == 0.0
    assert drive(0.002, actuator) == 0.0
    assert drive(0.003, actuator) == pytest.approx(20 / 4096)


def test_encoder_grid() -> None:
    """The arm's angle is the nearest of 250 per revolution, over any number of revolutions."""
    for phi in np.random.default_rng(9).uniform(-50, 50, 200):
        read = measured([phi, 0, 0, 0])[PHI]
        assert read * 250 / (2 * np.pi) == pytest.approx(round(phi * 250 / (2 * np.pi)))
    assert measured([0.012, 0, 0, 0])[PHI] == 0.0
    assert measured([0.013, 0, 0, 0])[PHI] == pytest.approx(2 * np.pi / 250)
    assert measured([0.012, 0, 0, 0], encoder_counts=0)[PHI] == 0.012


def test_potentiometer() -> None:
    """Resolution 3.8e-4 rad, clipped at ±π/4, one turn like another, no reading of θ̇."""
    read = [measured([0, 0, theta, 9.0])[THETA] for theta in np.linspace(-0.7, 0.7, 20001)]
    assert np.unique(np.diff(read).round(9)) == pytest.approx([0, np.pi / 2 / 4096], abs=1e-9)
    assert np.pi / 2 / 4096 == pytest.approx(3.8e-4, rel=0.02)
    for theta in (1.0, 2.0, 3.0):
        assert measured([0, 0, theta, 0])[THETA] == pytest.approx(np.pi / 4, abs=4e-4)
        assert measured([0, 0, -theta, 0])[THETA] == pytest.approx(-np.pi / 4, abs=4e-4)
    for turns in (-3, 1, 10):
        turned = measured([0, 0, 0.3 + 2 * np.pi * turns, 0])[THETA]
        assert turned == pytest.approx(0.3, abs=2e-4)
    assert math.isnan(measured([0, 0, 0, 9.0])[THETA_DOT])


def test_noise_enters_before_the_converter() -> None:
    """Tachometer and potentiometer get their noise in standard deviations, still clipped."""
    noise = np.array([3.0, -2.0])
    read = measured([1.0, 1.0, 0.1, 0.0], noise, tachometer_noise=0.5, potentiometer_noise=0.01)
    assert read[PHI_DOT] == pytest.approx(2.5, abs=20 / 4096)
    assert read[THETA] == pytest.approx(0.08, abs=4e-4)
    assert read[PHI] == measured([1.0, 0, 0, 0])[PHI]
    assert abs(measured([0, 9.9, 0, 0], noise, tachometer_noise=1.0)[PHI_DOT]) <= 10


def test_noise_is_one_seeded_stream() -> None:
    """Row k is the seed's row k, beyond a block too."""
    noise = Noise(3)
    rows = np.array([noise() for _ in range(2500)])
    assert np.array_equal(rows, np.random.default_rng(3).standard_normal((2500, 2)))
