r"""Criteria of a single swing-up, after the double-pendulum competition, and its score.

The competition (F. Wiebe et al., *Open source dual-purpose acrobot and pendubot platform*, IEEE
Robotics & Automation Magazine 31(2), 2024; the definitions are those of ``analysis/leaderboard.py``
and ``leaderboard/acrobot/simulation_v2`` in dfki-ric-underactuated-lab/double_pendulum) scores

.. math::
    S = s \Bigl(1 - \tfrac15 \sum_i \tanh\frac{\pi c_i}{n_i}\Bigr)

with s = 1 for a success and the five criteria time, energy, torque cost, torque smoothness and
velocity cost. Its constants n_i are in units of its double pendulum. They are converted here by
three numbers of that acrobot: its torque limit, its energy from hanging to upright, and the
frequency of its passive joint about upright with straight links.
"""

from __future__ import annotations

from math import sqrt, tanh
from typing import NamedTuple

import numpy as np

from furuta.studies.swing_up.disturbed_drive import DRIVE_PERIOD, DisturbedRun
from furuta.studies.swing_up.rig_loop import upright_since
from furuta_model.state import PHI, PHI_DOT, THETA_DOT
from furuta_sim.simulation.closed_loop import Loop

# The acrobot of the competition, design C.1, model 1.0: torque limit [N m], gravity torque
# [N m] and frequency [rad/s] of its passive joint with straight links.
TORQUE_LIMIT = 6.0
GRAVITY_TORQUE = 3.82
FREQUENCY = 4.72
# The constants n of time [s], energy [J], torque cost [N² m² s], smoothness [N m] and velocity
# cost [rad²/s].
TIME, ENERGY, TORQUE_COST, SMOOTHNESS, VELOCITY_COST = 20.0, 60.0, 20.0, 0.1, 400.0


class Performance(NamedTuple):
    """Criteria of a run, and the score of all.

    ``energy`` is relative to that from hanging to upright, ``largest_torque``,
    ``integrated_torque``, ``torque_cost`` and ``torque_smoothness`` to the voltage limit,
    ``velocity_cost`` to the pendulum's frequency.
    """

    swing_up_time_s: float
    energy: float
    largest_torque: float
    integrated_torque_s: float
    torque_cost_s: float
    torque_smoothness: float
    velocity_cost_s: float
    score: float


def performance(run: DisturbedRun, loop: Loop) -> Performance:
    """The criteria of a run from hanging."""
    p, dt = loop.controller, run.sample_time
    u = run.command / p.voltage_limit
    every = max(1, round(DRIVE_PERIOD / dt))
    energy = np.sum(np.abs(np.diff(run.state[:, PHI]) * run.command[:-1])) / (2.0 * p.model.delta)
    speeds = run.state[:, (PHI_DOT, THETA_DOT)] / sqrt(p.model.delta / p.model.beta)
    time = upright_since(run.state, dt)
    found = {
        "swing_up_time_s": time,
        "energy": float(energy),
        "largest_torque": float(np.max(np.abs(u))),
        "integrated_torque_s": float(np.sum(np.abs(u)) * dt),
        "torque_cost_s": float(u @ u) * dt,
        "torque_smoothness": float(np.std(np.diff(u[::every]))),
        "velocity_cost_s": float(np.sum(speeds**2)) * dt,
    }
    return Performance(**found, score=_score(found))


def _score(found: dict[str, float]) -> float:
    if np.isnan(found["swing_up_time_s"]):
        return 0.0
    constants = {
        "swing_up_time_s": TIME,
        "energy": ENERGY / (2.0 * GRAVITY_TORQUE),
        "torque_cost_s": TORQUE_COST / TORQUE_LIMIT**2,
        "torque_smoothness": SMOOTHNESS / TORQUE_LIMIT,
        "velocity_cost_s": VELOCITY_COST / FREQUENCY**2,
    }
    lost = [tanh(np.pi * found[name] / constant) for name, constant in constants.items()]
    return 1.0 - sum(lost) / len(lost)
