"""Whether a recording shows an elastic coupling of motor and arm: fits to simulated rigs."""

from pathlib import Path

import numpy as np
import pytest

from furuta_control.control import ControllerParameters
from furuta_control.excitation import ExcitationParameters
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.rig_file import load_rig, rig_file_text
from furuta_identification.fitting.coupling import find_coupling
from furuta_identification.identify import identify
from furuta_identification.model import Model
from furuta_identification.options import Options
from furuta_identification.result.identified_rig import identified_rig
from furuta_identification.result.report import summary
from furuta_model.converter import drive
from furuta_model.parts.coupling import Coupling
from furuta_recordings.recording import Recording
from furuta_sim.parameters import PlantParameters
from furuta_sim.simulation.closed_loop import Loop, simulate

BELT = Coupling(frequency=60.0, damping=0.04, motor_inertia=0.4, sensors="motor")


def fitted(coupling: Coupling, seconds: float = 3.0) -> Model:
    """The model of a balanced pendulum under a multisine, with its coupling."""
    plant = PlantParameters(coupling=coupling)
    signal = ExcitationParameters("multisine", amplitude=1.0)
    run = simulate(Loop(plant=plant, controller=ControllerParameters(excitation=signal)), seconds)
    command = np.array([drive(float(u), plant.actuator) for u in run.command])
    recording = Recording("driven", run.time, run.measurement[:, :4].copy(), run.time, command)
    model = identify([recording], Options(zero="upright"))
    return model._replace(coupling=find_coupling(model))


@pytest.fixture(scope="module")
def belt() -> Model:
    """The model of a rig with a belt."""
    return fitted(BELT)


def test_a_belt_is_found_within_four_standard_errors(belt: Model) -> None:
    found, errors, _ = belt.coupling
    assert found.sensors == "motor"
    assert set(errors) == {"frequency", "damping", "motor_inertia"}
    for name, error in errors.items():
        assert abs(getattr(found, name) - getattr(BELT, name)) < 4.0 * error
    assert errors["frequency"] < 0.02 * BELT.frequency


def test_the_belt_is_reported_and_written(belt: Model, tmp_path: Path) -> None:
    assert summary(belt)["coupling"]["frequency"] == belt.coupling.coupling.frequency
    rig, uncertainty = identified_rig(belt, Rig())
    file = tmp_path / "rig.yaml"
    file.write_text(rig_file_text(rig, uncertainty, "belt"), encoding="utf-8")
    assert load_rig(file).coupling.frequency == pytest.approx(60.0, rel=0.02)


@pytest.mark.long
def test_a_rigid_arm_shows_no_coupling() -> None:
    coupling, errors, remark = fitted(Coupling()).coupling
    assert not coupling.is_elastic
    assert not errors
    assert "does not show an elastic coupling or backlash" in remark


@pytest.mark.long
def test_backlash_is_no_resonance() -> None:
    coupling, _, remark = fitted(BELT._replace(frequency=150.0, backlash=0.003)).coupling
    assert not coupling.is_elastic
    assert "the recording shows backlash (arm's sensors on the motor)" in remark
