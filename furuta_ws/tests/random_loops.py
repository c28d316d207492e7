"""Random closed loops of every kind that runs in lanes, and random servo axes."""

import numpy as np
from part_parameters import controller

from furuta.axis.axis import Axis, Pid
from furuta_control.estimation import EstimatorParameters
from furuta_friction.compensation import ObserverParameters
from furuta_model.friction.parameters import Friction
from furuta_model.late_drive import LateDrive
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Actuator, Sensors
from furuta_sim.parameters import InitialState, PlantFriction, PlantParameters
from furuta_sim.simulation.closed_loop import Loop

LAWS = ("coulomb", "stiction", "stribeck", "lugre", "dahl")
METHODS = ("kalman", "lowpass")


def random_loop(
    r: np.random.Generator, law: str, compensation: str, method: str, ideal: bool
) -> Loop:
    """A loop with random parameters; some start so far off upright that they fall."""
    sensors = Sensors(ideal=ideal, encoder_counts=int(r.choice([0, 250, 4000])))
    friction = Friction(
        80.0 * r.uniform(0.3, 10.0),
        1.5 * r.uniform(0.3, 1.5),
        r.uniform(0.0, 0.4),
        r.uniform(0.0, 0.1),
        r.uniform(0.01, 0.1),
        r.uniform(0.0, 0.02),
        r.uniform(-0.3, 0.3),
    )
    body = FurutaPendulum(*(each * r.uniform(0.9, 1.1) for each in FurutaPendulum()))
    start = InitialState(theta=float(r.choice([0.02, -0.1, 0.18, 0.5, 3.0])), phi=r.uniform(-1, 1))
    plant = PlantParameters(
        body,
        PlantFriction(law, friction),
        sensors,
        Actuator(bits=int(r.choice([0, 8, 12]))),
        initial=start,
        seed=int(r.integers(2**40)),
    )
    drive = LateDrive(int(r.choice([0, 7])), float(r.choice([0.0, 0.01])))
    control = controller(
        integral_time=float(r.choice([0.0, 5.0])),
        strength=float(r.choice([1.0, 0.3])),
    )
    estimator = EstimatorParameters(method, sensors=sensors, drive=drive)
    return Loop(plant, estimator, ObserverParameters(compensation, drive=drive), control)


# Ranges of the logarithms to base 10: inertia [kg m²], natural frequency [rad/s], Coulomb level
# [N m], damping ratio, and what static friction is above the Coulomb level, relative to it.
LOW = (-4.0, 0.0, -3.0, -1.0, -1.3)
HIGH = (2.0, 2.0, 2.0, 0.3, 0.5)
INTEGRAL = (0.02, 0.95)  # k_i, relative to the largest that is stable, k_p k_d / J


def random_axis(random: np.random.Generator, law: str) -> tuple[Axis, Pid]:
    """An axis under this friction law and a PID that is stable without friction."""
    inertia, frequency, level, damping, excess = 10.0 ** random.uniform(LOW, HIGH)
    friction = Friction(alpha0=level, alpha1=0.0 if law == "coulomb" else excess * level)
    kp, kd = inertia * frequency**2, 2.0 * damping * inertia * frequency
    ki = float(random.uniform(*INTEGRAL)) * kp * kd / inertia
    return Axis(float(inertia), friction, law), Pid(float(kp), ki, float(kd))
