"""The experiment of all simulators: the limit cycle of the ideal loop, feedback held for 1 ms.

All states are measured exactly, there is no compensation, and the pendulum is released 0.05 rad off
upright. Equations (1) and (5) are repeated here in plain Python for the solvers under comparison.
"""

from math import cos, exp, sin

import numpy as np
from scipy.integrate import odeint

from furuta.oscillation import Oscillation, measure_oscillation
from furuta_control.control import ControllerParameters
from furuta_control.estimation import EstimatorParameters
from furuta_model.friction.parameters import Friction
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Actuator
from furuta_sim.parameters import PlantParameters, Sensors
from furuta_sim.simulation.closed_loop import Loop, simulate

SECONDS = 60.0
STEP = 1e-3
RELEASE = 0.05
BODY, FRICTION = FurutaPendulum(), Friction()
SENSORS = Sensors(ideal=True)
LOOP = Loop(
    PlantParameters(sensors=SENSORS, actuator=Actuator(bits=0), sample_time=STEP),
    EstimatorParameters(sensors=SENSORS, sample_time=STEP),
)
# u = l·x
FEEDBACK = tuple(-gain for gain in ControllerParameters().feedback_gain)
# Periods of the accurate solution; the first third of them is not measured.
PERIODS = 4


def measure_cycle(phi: np.ndarray, theta: np.ndarray) -> Oscillation:
    """Amplitude and period of a motion sampled every ``STEP``, without transients."""
    state = np.zeros((len(phi), 4))
    state[:, 0], state[:, 2] = phi, theta
    return measure_oscillation(state, STEP)


def command(x: np.ndarray) -> float:
    """Command u [V] in state ``x``."""
    l1, l2, l3, l4 = FEEDBACK
    return float(l1 * x[0] + l2 * x[1] + l3 * x[2] + l4 * x[3])


def state_rate(_: float, x: np.ndarray, u: float | None = None) -> list[float]:
    """ẋ (5,) with the command ``u`` [V], or with continuous feedback if it is not given."""
    _, v, theta, w, z = x
    p = BODY
    level = FRICTION.alpha0 + FRICTION.alpha1 * exp(-((v / FRICTION.stribeck_velocity) ** 2))
    z_dot = v - FRICTION.sigma0 * abs(v) / level * z
    force = FRICTION.sigma0 * z + FRICTION.sigma1 * z_dot
    s, c = sin(theta), cos(theta)
    arm = (command(x) if u is None else u) - force
    arm += p.gamma * s * w * w - 2 * p.beta * c * s * v * w
    pendulum = (p.beta * c * v * v + p.delta) * s
    inertia, coupling = p.alpha + p.beta * s * s, p.gamma * c
    determinant = inertia * p.beta - coupling * coupling
    v_dot = (p.beta * arm - coupling * pendulum) / determinant
    w_dot = (inertia * pendulum - coupling * arm) / determinant
    return [v, v_dot, w, w_dot, z_dot]


def accurate_limit_cycle() -> Oscillation:
    """The limit cycle with held feedback, each step solved by LSODA to ten digits."""
    simulated = simulated_limit_cycle()
    x = np.append(simulate(LOOP, SECONDS).state[-1], 0.0)
    samples = round(PERIODS * simulated.period_s / STEP)
    path = np.empty((samples, 5))
    for k in range(samples):
        path[k] = x
        x = odeint(
            state_rate, x, [0.0, STEP], args=(command(x),), tfirst=True, rtol=1e-10, atol=1e-12
        )[-1]
    settled = path[samples // 3 :]
    return measure_cycle(settled[:, 0], settled[:, 2])


def simulated_limit_cycle() -> Oscillation:
    """The limit cycle of the simulation of this project."""
    record = simulate(LOOP, SECONDS)
    settled = record.state[len(record.state) // 2 :]
    return measure_oscillation(settled, STEP)
