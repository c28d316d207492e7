r"""Tracks an optimised swing-up from hanging at rest, by a time-varying linear-quadratic regulator.

The trajectory is given by the torque u − F [V] at equal intervals, linear between them. The states
follow from eq. (1). The regulator is computed backwards in time from the exact linearisation of
every step,

.. math::
    K_k = (R + B_k^T P_{k+1} B_k)^{-1} B_k^T P_{k+1} A_k, \qquad
    P_k = Q + A_k^T P_{k+1} (A_k - B_k K_k)

and ends with the cost of the regulator that catches the pendulum. The friction estimate is added.
"""

from math import ceil
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled, inlined
from furuta_model.pendulum import FurutaPendulum, accelerations
from furuta_model.state import PHI, PHI_DOT, RIGID_STATES, THETA, THETA_DOT

# Rows of the table, at equal intervals over the trajectory.
ROWS = 512
# Columns: state (4), torque u − F [V], gain (4).
TORQUE = RIGID_STATES
GAIN = TORQUE + 1
COLUMNS = GAIN + RIGID_STATES
# Deviations from the trajectory [rad], speed relative to ω: in the weights, and when it is lost.
DEVIATION = 0.1
LOST = 0.6
# Hanging at rest: largest angle [rad], pendulum speed relative to ω, arm angle [rad].
START_ANGLE = 0.1
START_SPEED = 0.1
START_ARM_ANGLE = 0.5
# Arm speed [rad/s] at which the time starts to run, so that it waits for a drive that is not armed.
MOVING = 0.3
# Step of the differences that linearise [rad, rad/s, V].
DIFFERENCE = 1e-6


class Tracking(NamedTuple):
    """Table (ROWS, COLUMNS), number of samples (0: no trajectory), ω [rad/s]."""

    table: np.ndarray
    samples: int
    frequency: float


def unused() -> Tracking:
    """No trajectory."""
    return Tracking(np.zeros((ROWS, COLUMNS)), 0, 1.0)


def design(
    model: FurutaPendulum,
    torques: tuple[float, ...],
    duration: float,
    voltage: float,
    arm_deviations: tuple[float, float],
    final_cost: np.ndarray,
    dt: float,
) -> Tracking:
    """The trajectory with its regulator, for samples of ``dt`` [s].

    ``arm_deviations`` [rad, rad/s] and ``voltage`` [V] scale the weights.
    """
    h = duration / (ROWS - 1)
    table = np.zeros((ROWS, COLUMNS))
    table[:, TORQUE] = np.interp(
        np.linspace(0.0, 1.0, ROWS), np.linspace(0.0, 1.0, len(torques)), torques
    )
    roll_out(table, h, model)
    frequency = float(np.sqrt(model.delta / model.beta))
    deviations = np.array((*arm_deviations, DEVIATION, DEVIATION * frequency))
    _regulate(table, h, model, np.diag(deviations**-2), voltage**-2, final_cost)
    return Tracking(table, ceil(duration / dt), frequency)


@compiled
def step(x: np.ndarray, torque: float, h: float, model: FurutaPendulum) -> None:
    """Move state ``x`` (4,) over ``h`` [s] at constant torque [V], by the midpoint rule."""
    v, w = x[PHI_DOT], x[THETA_DOT]
    v_dot, w_dot = accelerations(v, x[THETA], w, torque, model)
    v_mid, w_mid = v + 0.5 * h * v_dot, w + 0.5 * h * w_dot
    v_dot, w_dot = accelerations(v_mid, x[THETA] + 0.5 * h * w, w_mid, torque, model)
    x[PHI] += h * v_mid
    x[THETA] += h * w_mid
    x[PHI_DOT], x[THETA_DOT] = v + h * v_dot, w + h * w_dot


@compiled
def roll_out(table: np.ndarray, h: float, model: FurutaPendulum) -> None:
    """Write the states that follow from the torques in ``table``, from hanging at rest."""
    x = np.zeros(RIGID_STATES)
    x[THETA] = -np.pi
    table[0, :RIGID_STATES] = x
    for k in range(len(table) - 1):
        step(x, 0.5 * (table[k, TORQUE] + table[k + 1, TORQUE]), h, model)
        table[k + 1, :RIGID_STATES] = x


@compiled
def _linearized(
    x: np.ndarray, torque: float, h: float, model: FurutaPendulum
) -> tuple[np.ndarray, np.ndarray]:
    """A (4, 4) and B (4,) of one step, by central differences."""
    a, b = np.empty((RIGID_STATES, RIGID_STATES)), np.empty(RIGID_STATES)
    for j in range(RIGID_STATES + 1):
        above, below = x.copy(), x.copy()
        change = 0.0
        if j < RIGID_STATES:
            above[j] += DIFFERENCE
            below[j] -= DIFFERENCE
        else:
            change = DIFFERENCE
        step(above, torque + change, h, model)
        step(below, torque - change, h, model)
        slope = (above - below) / (2.0 * DIFFERENCE)
        if j < RIGID_STATES:
            a[:, j] = slope
        else:
            b[:] = slope
    return a, b


def _regulate(
    table: np.ndarray,
    h: float,
    model: FurutaPendulum,
    state_weight: np.ndarray,
    torque_weight: float,
    final_cost: np.ndarray,
) -> None:
    """Write the gains to ``table``, backwards in time; weights are per second."""
    cost = final_cost
    for k in range(len(table) - 2, -1, -1):
        torque = 0.5 * (table[k, TORQUE] + table[k + 1, TORQUE])
        a, b = _linearized(table[k, :RIGID_STATES], torque, h, model)
        gain = (b @ cost @ a) / (torque_weight * h + b @ cost @ b)
        cost = state_weight * h + a.T @ cost @ (a - np.outer(b, gain))
        cost = 0.5 * (cost + cost.T)
        table[k, GAIN:] = gain
    table[-1, GAIN:] = table[-2, GAIN:]


@inlined
def can_start(x: np.ndarray, p: Tracking) -> bool:
    """Whether there is a trajectory and it starts in state ``x``."""
    return (
        p.samples > 0
        and np.pi - abs(x[THETA]) < START_ANGLE
        and abs(x[THETA_DOT]) < START_SPEED * p.frequency
        and abs(x[PHI]) < START_ARM_ANGLE
        and abs(x[PHI_DOT]) < MOVING
    )


@inlined
def deviation(x: np.ndarray, k: int, i: int, p: Tracking) -> float:
    """Deviation of state i from the trajectory after ``k`` samples; of θ within ±π."""
    row = k / p.samples * (ROWS - 1)
    first = min(int(row), ROWS - 2)
    part = row - first
    wanted = p.table[first, i] + part * (p.table[first + 1, i] - p.table[first, i])
    error = x[i] - wanted
    if i == THETA:
        error -= 2.0 * np.pi * np.floor(error / (2.0 * np.pi) + 0.5)
    return error


@inlined
def lost(x: np.ndarray, k: int, p: Tracking) -> bool:
    """Whether the pendulum is too far from the trajectory, or the trajectory is over."""
    if k >= p.samples:
        return True
    return (
        abs(deviation(x, k, THETA, p)) > LOST
        or abs(deviation(x, k, THETA_DOT, p)) > LOST * p.frequency
    )


@inlined
def command(x: np.ndarray, k: int, friction: float, p: Tracking) -> float:
    """Command u [V], unsaturated, after ``k`` samples, for the friction estimate [V]."""
    row = min(int(k / p.samples * (ROWS - 1)), ROWS - 1)
    u = friction + p.table[row, TORQUE]
    for i in range(RIGID_STATES):
        u -= p.table[row, GAIN + i] * deviation(x, k, i, p)
    return u
