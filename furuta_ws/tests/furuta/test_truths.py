"""The closed loop on rigs that are not the model: it stays up, and each part has its effect."""

import numpy as np
import pytest

from furuta.outcomes import outcome
from furuta_control.estimation import EstimatorParameters
from furuta_friction.compensation import ObserverParameters
from furuta_model.parameters import build
from furuta_model.sensors import Sensors
from furuta_model.state import THETA
from furuta_sim.parameters import PlantParameters
from furuta_sim.simulation.closed_loop import Loop, simulate


@pytest.mark.parametrize("method", ["kalman", "lowpass"])
@pytest.mark.parametrize("ideal", [False, True])
@pytest.mark.parametrize("compensation", ["none", "coulomb", "lugre"])
def test_missing_readings_do_not_fell_the_loop(method: str, ideal: bool, compensation: str) -> None:
    """Single NaN in any reading, one in twenty, and the limit cycle stays what it is."""
    loop = Loop(
        build(PlantParameters, {"sensor_faults.missing": 0.05, "sensors.ideal": ideal}),
        EstimatorParameters(method, sensors=Sensors(ideal=ideal)),
        ObserverParameters(compensation),
    )
    spoilt = simulate(loop, 20.0)
    assert np.all(np.isfinite(spoilt.command))
    assert np.all(np.isfinite(spoilt.estimate[1000:, :4]))
    assert np.abs(spoilt.state[:, THETA]).max() < 0.2


def size(given: dict[str, object], compensation: str = "none") -> float:
    """Peak to peak of the arm [rad]."""
    loop = Loop(build(PlantParameters, given), observer=ObserverParameters(compensation))
    result = outcome(loop, 30.0)
    assert not result.fell
    return result.phi_peak_to_peak_rad


def test_compensation_is_worse_on_a_rig_that_is_not_its_model() -> None:
    """Measured on an independent plant: cogging of 0.05 V 0.12 rad, level ±30 % 0.14 to 0.15."""
    cogging = {"cogging.torque": 0.05}
    assert size(cogging) == pytest.approx(0.52, abs=0.01)
    assert size(cogging, "lugre") == pytest.approx(0.129, abs=0.02)
    assert size(cogging, "coulomb") == pytest.approx(0.117, abs=0.02)
    assert size({}, "lugre") < 0.03


def test_a_truth_without_presliding_defeats_the_observer_with_a_bristle() -> None:
    """Measured on an independent plant: 0.287 rad where the arm truly sticks, Coulomb 0.012."""
    sticking = {"friction.law": "coulomb"}
    assert size(sticking, "lugre") == pytest.approx(0.287, abs=0.02)
    assert size(sticking, "coulomb") < 0.03
