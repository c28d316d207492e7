"""The rig: converters, sensors, noise, and one sample of it."""

import math

import numpy as np
import pytest
import reference

from furuta_model.converter import Actuator, convert, drive
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT
from furuta_sim.parameters import PlantParameters, Sensors
from furuta_sim.plant import Noise, design_plant, initial_plant, measure, move

QUIET = np.zeros(2)


def measured(x: list[float], noise: np.ndarray = QUIET, **sensors: object) -> np.ndarray:
    """One measurement (4,)."""
    measurement = np.full(4, 99.0)
    measure(np.array([*x, 0.0]), noise, Sensors(**sensors), measurement)
    return measurement


@pytest.mark.parametrize("bits", [1, 3, 12, 32])
@pytest.mark.parametrize("full_scale", [10.0, math.pi / 4])
def test_codes_of_a_converter(full_scale: float, bits: int) -> None:
    """Outputs are whole codes from −2ⁿ⁻¹ to 2ⁿ⁻¹ − 1, within half a code of the input."""
    code = 2 * full_scale / 2**bits
    for value in np.random.default_rng(7).uniform(-full_scale, full_scale - code, 200):
        output = convert(value, full_scale, bits)
        assert output / code == pytest.approx(round(output / code), abs=1e-6)
        assert abs(output - value) <= code / 2 * (1 + 1e-9)
        assert convert(output, full_scale, bits) == output
    assert convert(1e3 * full_scale, full_scale, bits) == pytest.approx(full_scale - code)
    assert convert(-1e3 * full_scale, full_scale, bits) == pytest.approx(-full_scale)


def test_converter_without_bits() -> None:
    """With 0 bits a converter clips and does nothing else."""
    values = np.random.default_rng(8).uniform(-20, 20, 100)
    converted = [convert(value, 10.0, 0) for value in values]
    assert converted == list(np.clip(values, -10, 10))


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (-1e30, -10.0),
        (-math.inf, -10.0),
        *((value, 10.0 - 20 / 4096) for value in (1e17, 1e30, math.inf)),
    ],
)
def test_converter_far_beyond_its_range(value: float, expected: float) -> None:
    """However large, a value keeps its sign."""
    assert convert(value, 10.0, 12) == pytest.approx(expected)


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
    """Row k is the seed's row k however large the blocks; other seeds, other rows."""
    noise = Noise(3)
    rows = np.array([noise() for _ in range(2500)])
    assert np.array_equal(rows, np.random.default_rng(3).standard_normal((2500, 2)))

    class SmallBlocks(Noise):
        BLOCK = 7

    noise = SmallBlocks(3)
    assert np.array_equal(rows, [noise() for _ in range(2500)])
    assert not np.any(Noise(4)() == rows[0])
    assert np.abs(rows.mean(0)).max() < 0.06
    assert rows.std(0) == pytest.approx([1, 1], abs=0.06)


def test_one_sample_of_the_rig() -> None:
    """A sample moves the plant under the drive's clipped and rounded voltage, held."""
    plant = PlantParameters(sample_time=0.005)
    for command, torque in ((50.0, 10 - 20 / 4096), (0.006, 20 / 4096)):
        memory = initial_plant(plant)[0]
        x = memory["x"]
        x[:] = [0.1, 0.5, 0.05, -0.2, 0.001]
        expected = reference.plant_after(x, torque, 0.005, plant.model, plant.friction.parameters)
        made = design_plant(plant)
        move(memory, command, made._replace(substeps=8 * made.substeps))
        assert x == pytest.approx(expected, abs=2e-5)
