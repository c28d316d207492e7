"""The limit cycle of every friction law against an independent integration with events.

By default one parameter set per law runs; ``FURUTA_ALL_LAWS=1`` runs all five.
"""

import os

import numpy as np
import pytest
from event_reference import EventLoop

from furuta.oscillation import measure_oscillation
from furuta_control.control import ControllerParameters
from furuta_control.estimation import EstimatorParameters
from furuta_friction.compensation import ObserverParameters
from furuta_model.converter import Actuator
from furuta_model.friction.laws import LAWS
from furuta_model.friction.parameters import Friction
from furuta_model.sensors import Sensors
from furuta_model.state import PHI
from furuta_sim.parameters import PlantFriction, PlantParameters
from furuta_sim.simulation.closed_loop import Loop, Simulation

# Short enough that the sampled controller is the continuous one within 3e-5.
STEP = 2e-5
SECONDS = 30.0
SETS = [
    Friction(),
    Friction(alpha0=0.3, asymmetry=0.1),
    Friction(sigma0=160.0, sigma1=3.0, alpha1=0.05),
    Friction(alpha1=0.1, viscous=0.01, stribeck_velocity=0.1),
    Friction(sigma0=40.0, alpha0=0.15, alpha1=0.0, asymmetry=-0.2),
]
CHOSEN = range(len(SETS)) if os.environ.get("FURUTA_ALL_LAWS") else range(1, 2)


# Dahl's law is LuGre's without damping.
@pytest.mark.parametrize(
    "law",
    [pytest.param(law, marks=[pytest.mark.long] if law == "dahl" else []) for law in LAWS],
)
@pytest.mark.parametrize("number", CHOSEN)
def test_limit_cycle_of_a_law(law: str, number: int) -> None:
    """Peak to peak and period agree within 0.01 %; the sampled controller costs a quarter of it."""
    p, springs, sensors = SETS[number], number + 2, Sensors(ideal=True)
    controller = ControllerParameters(sample_time=STEP)
    simulation = Simulation(
        Loop(
            PlantParameters(
                friction=PlantFriction(law, p, springs),
                sensors=sensors,
                actuator=Actuator(bits=0),
                sample_time=STEP,
            ),
            EstimatorParameters(sensors=sensors, sample_time=STEP),
            ObserverParameters(sample_time=STEP),
            controller,
        )
    )
    record = simulation.run(SECONDS)
    settled = record.state[len(record.state) // 2 :]
    found, middle = measure_oscillation(settled, STEP), 0.5 * np.ptp(settled[:, PHI])
    middle += float(settled[:, PHI].min())
    own = {"lugre": 1, "dahl": 1}.get(law, 0)
    x = simulation.state[: 4 + own]
    if law == "maxwell_slip":
        x = np.append(x, simulation.memory["plant"]["springs"][0, :springs])
    gains = -np.array(controller.feedback_gain)
    loop = EventLoop(law, p, gains, springs if law == "maxwell_slip" else 0)
    cycle = loop.run(x, 3.2 * found.period_s, middle)
    assert found.phi_peak_to_peak_rad == pytest.approx(cycle.peak_to_peak, rel=1e-4)
    assert found.period_s == pytest.approx(cycle.period, rel=1e-4)
