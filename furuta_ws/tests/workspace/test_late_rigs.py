"""The independent plant of benchmarks/two_masses.py, and the study of benchmarks/late_rigs.py."""

from importlib import import_module
from math import pi
from typing import Any

import numpy as np
import pytest
from sources import ROOT

import furuta
from furuta.oscillation import measure_oscillation
from furuta_model.friction.parameters import Friction
from furuta_model.pendulum import FurutaPendulum

DT = 1e-3


@pytest.fixture
def study(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The script, with the plant as ``two_masses``."""
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    return import_module("late_rigs")


def friction(study: Any, law: str) -> Any:
    """The paper's friction."""
    p = Friction()
    return study.DryFriction(
        study.LAWS.index(law), p.alpha0, p.alpha0, p.alpha1, p.stribeck_velocity, p.sigma0, p.sigma1
    )


def rig(study: Any, law: str, belt: Any = None) -> Any:
    """The paper's rig with a law."""
    plant = study.two_masses(tuple(FurutaPendulum()), friction(study, law), belt)
    return study.LateRig(law, plant, belt is not None, 1.0, (0.0, 0.0), (0.0, 0.0))


@pytest.mark.parametrize("law", ["stiction", "stribeck", "lugre"])
def test_without_compensation_it_swings_as_the_simulated_rig_does(study: Any, law: str) -> None:
    """Amplitude and period of the limit cycle agree to a per cent, through the same sensors."""
    loop = furuta.make_loop({"compensation": "none", "plant.friction.law": law})
    expected = measure_oscillation(furuta.simulate(loop, 40.0).state[20_000:], DT)
    _, states = study.RigLoop(rig(study, law), loop, (0, 0)).run(40.0)
    swing = measure_oscillation(states[20_000:], DT)
    assert swing.phi_peak_to_peak_rad == pytest.approx(expected.phi_peak_to_peak_rad, rel=0.01)
    assert swing.period_s == pytest.approx(expected.period_s, rel=0.01)


def test_an_elastic_arm_swings_as_the_simulated_one_does(study: Any) -> None:
    """Two masses with a gap, and friction on both."""
    belt = study.Belt(60.0, 0.03, 0.4, 0.002, 0.3, senses_motor=True)
    names = {"frequency": 60.0, "motor_inertia": 0.4, "backlash": 0.002, "arm_friction": 0.3}
    values = {f"plant.coupling.{name}": value for name, value in names.items()}
    loop = furuta.make_loop(
        {"compensation": "none", "plant.coupling.sensors": "motor", **values},
    )
    expected = np.ptp(furuta.simulate(loop, 40.0).state[20_000:, 0])
    _, states = study.RigLoop(rig(study, "lugre", belt), loop, (0, 0)).run(40.0)
    assert np.ptp(states[20_000:, 0]) == pytest.approx(expected, rel=0.02)


def test_a_command_below_the_friction_moves_nothing(study: Any) -> None:
    """The hanging pendulum's arm sticks exactly, and breaks away above the level at rest."""
    plant = rig(study, "stiction").plant
    x, sent = study.released(pi)
    for _ in range(100):
        study.move_plant(x, sent, 0.23, plant)
    assert x[0] == 0.0
    study.move_plant(x, sent, 0.233, plant)
    assert x[0] > 0.0


def test_a_late_drive_acts_late(study: Any) -> None:
    """Nothing before the delay; behind the lag 1 - 1/e of the voltage after its time constant."""
    body = tuple(FurutaPendulum())
    plant = study.two_masses(body, friction(study, "coulomb"), None, delay=0.0023, lag=0.005)
    x, sent = study.released(pi)
    torques = []
    for _ in range(10):
        study.move_plant(x, sent, 1.0, plant)
        torques.append(x[6])
    assert torques[1] == 0.0
    expected = 1.0 - np.exp(-(DT * np.arange(3, 11) - 0.0023) / 0.005)
    assert torques[2:] == pytest.approx(expected, rel=1e-6)


def test_the_recommended_setting_helps_on_a_late_rig(study: Any) -> None:
    """Told, it stays within a count of the encoder, where none swings by tenths of a radian."""
    swings = study.study(2, ("none", "right", "wrong"))
    assert swings["none"] > 0.4
    assert max(swings["right"], swings["wrong"]) < study.COUNT
