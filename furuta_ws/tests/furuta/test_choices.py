"""Every part that a list names is the one that runs when it is chosen."""

import numpy as np
import pytest

from furuta_control.control import MODES, ControllerMemory, control, design_controller
from furuta_control.control import ControllerParameters as Control
from furuta_control.estimation import METHOD_NAMES, EstimatorParameters
from furuta_control.excitation import ExcitationParameters
from furuta_model.block import new_memory
from furuta_model.friction.laws import ALL, LAWS, breakaway_level, friction_law, symmetric_level
from furuta_model.friction.parameters import Friction
from furuta_sim.simulation.closed_loop import Loop, simulate

P = Friction(alpha1=0.05)


@pytest.mark.parametrize("law", ALL, ids=LAWS)
def test_law(law: object) -> None:
    """Compiled code has the levels of the law at this place of the list."""
    name = LAWS[ALL.index(law)]  # type: ignore[arg-type]
    chosen = friction_law(name, P)
    assert chosen.law is law
    assert chosen.name == name
    for v in (0.0, 0.01, 0.5):
        assert symmetric_level(v, chosen) == chosen.law.level(v, P)
    at_rest = chosen.law.breakaway or (lambda p: chosen.law.level(0.0, p))
    assert breakaway_level(1.0, chosen) == at_rest(P)


@pytest.mark.parametrize("name", METHOD_NAMES)
def test_method(name: str) -> None:
    """Its estimate follows the pendulum, which stays upright."""
    run = simulate(Loop(estimator=EstimatorParameters(name)), 5.0)
    assert np.max(np.abs(run.state[:, 2])) < 0.1
    assert np.max(np.abs(run.estimate[:, 2] - run.state[:, 2])) < 0.01


@pytest.mark.parametrize("name", [mode.name for mode in MODES])
def test_mode(name: str) -> None:
    """It drives an arm that moves, unless it is off."""
    p = Control(mode=name, excitation=ExcitationParameters("steps"))
    memory, x = new_memory(ControllerMemory), np.array([0.1, 0.5, 0.01, 0.0])
    assert bool(control(memory[0], x, 0.0, design_controller(p))) == (name != "off")
