"""Identification of a balanced pendulum from simulated closed loops."""

import numpy as np
import pytest

from furuta.identification.identify import identify
from furuta.identification.model import Model
from furuta.identification.options import Options
from furuta.identification.result.values import standard_errors, values_by_name
from furuta_control.estimation import EstimatorParameters
from furuta_model.friction.parameters import Friction
from furuta_model.sensors import Sensors, drive, measure
from furuta_recordings.recording import Recording
from furuta_sim.parameters import PlantFriction, PlantParameters
from furuta_sim.plant import NOISE_CHANNELS
from furuta_sim.simulation.closed_loop import Loop, simulate

PAPER = {"a23": -11.0, "a43": 33.0, "b21": 45.0, "b41": -29.0}


def balanced(seconds: float, ideal: bool) -> Model:
    """The model from a recording of the simulated rig: sensor values and the drive's voltage."""
    friction = PlantFriction(parameters=Friction(asymmetry=0.1))
    plant = PlantParameters(friction=friction, sensors=Sensors(ideal=ideal))
    estimator = EstimatorParameters(sensors=Sensors(ideal=ideal))
    run = simulate(Loop(plant=plant, estimator=estimator), seconds)
    noise = np.random.default_rng(0).standard_normal((len(run.command), NOISE_CHANNELS))
    measured = np.empty((len(run.command), 4))
    for row, x, errors in zip(measured, run.state, noise, strict=True):
        measure(x, errors, plant.sensors, row)
    command = np.array([drive(u, plant.actuator) for u in run.command])
    return identify([Recording("balanced", run.time, measured, run.time, command)], Options())


def test_coefficients_of_the_paper_from_ideal_sensors() -> None:
    values = values_by_name(balanced(5.0, ideal=True))
    assert {name: values[name] for name in PAPER} == pytest.approx(PAPER, rel=1e-3)
    assert values["coulomb"] == pytest.approx(0.21, rel=1e-3)
    assert values["asymmetry"] == pytest.approx(0.1, rel=1e-3)


@pytest.mark.long
def test_coefficients_of_the_paper_from_the_closed_loop() -> None:
    """The same with the paper's sensors; the truth lies within four standard errors."""
    model = balanced(20.0, ideal=False)
    values, errors = values_by_name(model), standard_errors(model)
    assert {name: values[name] for name in PAPER} == pytest.approx(PAPER, rel=0.03)
    assert values["coulomb"] == pytest.approx(0.21, rel=0.05)
    assert values["asymmetry"] == pytest.approx(0.1, rel=0.05)
    for name, truth in PAPER.items():
        assert abs(values[name] - truth) < 4.0 * errors[name]
