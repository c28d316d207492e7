"""All friction laws under one interface, in the plant and in the analysis."""

import numpy as np
import pytest

from furuta.limit_cycles.limit_cycle import limit_cycle
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.oscillation import measure_oscillation
from furuta_control.control import ControllerParameters
from furuta_control.estimation import EstimatorParameters
from furuta_model.friction.laws import (
    ALL,
    ANALYSED_LAWS,
    friction_law,
    sliding_level,
)
from furuta_model.friction.parameters import Friction
from furuta_model.integration import advance, substeps_for
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Actuator, Sensors
from furuta_sim.parameters import PlantFriction, PlantParameters
from furuta_sim.simulation.closed_loop import Loop, simulate

P = Friction(alpha1=0.05, viscous=0.02, asymmetry=0.2)
STICKING = [law.name for law in ALL if not law.bristle]


@pytest.mark.parametrize("law", STICKING)
def test_the_arm_truly_sticks(law: str) -> None:
    body, friction = FurutaPendulum(), friction_law(law, P)
    x = np.array([0.3, 0.0, np.pi, 0.0, 0.0])
    for _ in range(2000):
        advance(x, 0.2, 1e-3, substeps_for(1e-3, body, P), body, friction)
    assert x[0] == pytest.approx(0.3, abs=1e-12)
    assert x[4] == pytest.approx(0.2, rel=1e-9)
    for _ in range(200):
        advance(x, 0.4, 1e-3, substeps_for(1e-3, body, P), body, friction)
    assert x[0] > 0.31
    assert x[4] == pytest.approx(sliding_level(x[1], 1.0, friction), rel=1e-3)


@pytest.mark.parametrize("law", ANALYSED_LAWS)
def test_limit_cycle_agrees_with_the_exact_one(law: str) -> None:
    """The limit cycle of the plant at 0.2 ms is within 0.5 % of the event-driven solution."""
    dt, p = 2e-4, Friction(asymmetry=0.1)
    controller = ControllerParameters(sample_time=dt)
    loop = Loop(
        PlantParameters(
            friction=PlantFriction(law, p),
            sensors=Sensors(ideal=True),
            actuator=Actuator(bits=0),
            sample_time=dt,
        ),
        EstimatorParameters(sensors=Sensors(ideal=True), sample_time=dt),
        controller=controller,
    )
    settled = simulate(loop, 40.0).state[100_000:]
    found = measure_oscillation(settled, dt)
    gains = tuple(-each for each in controller.feedback_gain)
    exact = limit_cycle(IdealLoop(loop.plant.model, friction_law(law, p), *gains))
    assert found.phi_peak_to_peak_rad == pytest.approx(exact.phi_peak_to_peak_rad, rel=5e-3)
    assert found.period_s == pytest.approx(exact.period_s, rel=5e-3)
