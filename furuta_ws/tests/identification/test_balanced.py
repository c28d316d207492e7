"""Identification of a balanced pendulum from simulated closed loops."""

import numpy as np
import pytest

from furuta.identification.identify import identify
from furuta.identification.model import Model
from furuta.identification.options import Options
from furuta.identification.result.report import standard_errors, summary
from furuta_control.control import ControllerParameters
from furuta_control.estimation import EstimatorParameters
from furuta_control.excitation import ExcitationParameters
from furuta_model.converter import drive
from furuta_model.friction.parameters import Friction
from furuta_model.sensors import Sensors, measure
from furuta_recordings.recording import Recording
from furuta_sim.parameters import PlantFriction, PlantParameters
from furuta_sim.plant import NOISE_CHANNELS
from furuta_sim.simulation.closed_loop import Loop, simulate

PAPER = {"a23": -11.0, "a43": 33.0, "b21": 45.0, "b41": -29.0}
UNDRIVEN = ExcitationParameters()


def balanced(seconds: float, ideal: bool, excitation: ExcitationParameters = UNDRIVEN) -> Model:
    """The model from a recording of the simulated rig: sensor values and the drive's voltage."""
    friction = PlantFriction(parameters=Friction(asymmetry=0.1))
    plant = PlantParameters(friction=friction, sensors=Sensors(ideal=ideal))
    estimator = EstimatorParameters(sensors=Sensors(ideal=ideal))
    controller = ControllerParameters(excitation=excitation)
    run = simulate(Loop(plant=plant, estimator=estimator, controller=controller), seconds)
    noise = np.random.default_rng(0).standard_normal((len(run.command), NOISE_CHANNELS))
    measured = np.empty((len(run.command), 4))
    for row, x, errors in zip(measured, run.state, noise, strict=True):
        measure(x, errors, plant.sensors, row)
    command = np.array([drive(u, plant.actuator) for u in run.command])
    return identify([Recording("balanced", run.time, measured, run.time, command)], Options())


def test_coefficients_of_the_paper_from_ideal_sensors() -> None:
    values = summary(balanced(5.0, ideal=True))
    assert {name: values[name] for name in PAPER} == pytest.approx(PAPER, rel=1e-3)
    assert values["coulomb"] == pytest.approx(0.21, rel=1e-3)
    assert values["asymmetry"] == pytest.approx(0.1, rel=1e-3)


@pytest.fixture(scope="module")
def undriven() -> Model:
    """The model from a limit cycle with the paper's sensors."""
    return balanced(20.0, ideal=False)


@pytest.mark.long
def test_coefficients_of_the_paper_from_the_closed_loop(undriven: Model) -> None:
    """The same with the paper's sensors; the truth lies within four standard errors."""
    values, errors = summary(undriven), standard_errors(undriven)
    assert {name: values[name] for name in PAPER} == pytest.approx(PAPER, rel=0.03)
    assert values["coulomb"] == pytest.approx(0.21, rel=0.05)
    assert values["asymmetry"] == pytest.approx(0.1, rel=0.05)
    for name, truth in PAPER.items():
        assert abs(values[name] - truth) < 4.0 * errors[name]


@pytest.mark.long
def test_excitation_reduces_the_errors(undriven: Model) -> None:
    driven = balanced(10.0, False, ExcitationParameters("multisine", amplitude=1.0))
    before, after, values = standard_errors(undriven), standard_errors(driven), summary(driven)
    for name, truth in PAPER.items():
        assert after[name] < before[name]
        assert values[name] == pytest.approx(truth, rel=0.01)
    assert after["a23"] < before["a23"] / 2.0
