"""Readers of typed messages into the arrays of the cores.

A state is an array in the order x = (φ, φ̇, θ, θ̇), followed by the arm's effort. Readers
validate messages and raise :class:`RefusedError` for invalid ones.
"""

from math import nan

import numpy as np
from sensor_msgs.msg import JointState

from furuta_model.parameters import shortened
from furuta_model.state import EFFORT, LARGEST_VALUE, PHI, PHI_DOT, THETA, THETA_DOT
from furuta_ros.topics import JOINTS


class RefusedError(ValueError):
    """A message is invalid; the error says why."""


def read_joints(message: JointState, x: np.ndarray) -> None:
    """Write the message's state and the arm's effort to ``x`` (5,); NaN is an unknown value.

    Raises:
        RefusedError: The message is invalid; ``x`` is unchanged.
    """
    *state, effort = _values(message)
    if any(abs(value) > LARGEST_VALUE for value in state):
        raise RefusedError(
            f"values must be finite and at most {LARGEST_VALUE:g}, given position "
            f"{list(message.position)}, velocity {list(message.velocity)}"
        )
    if abs(effort) > LARGEST_VALUE:
        raise RefusedError(f"effort must be at most {LARGEST_VALUE:g}, given {effort}")
    x[PHI], x[PHI_DOT], x[THETA], x[THETA_DOT] = state
    x[EFFORT] = effort


def read_measurement(message: JointState, measurement: np.ndarray) -> None:
    """Write the message's readings and the arm's effort to ``measurement`` (5,), whatever they are.

    The estimator decides which readings it can use.

    Raises:
        RefusedError: The message is invalid; ``measurement`` is unchanged.
    """
    *state, effort = _values(message)
    measurement[PHI], measurement[PHI_DOT], measurement[THETA], measurement[THETA_DOT] = state
    measurement[EFFORT] = effort


def _values(message: JointState) -> tuple[float, float, float, float, float]:
    """φ, φ̇, θ, θ̇ and the effort of the arm (NaN if there is none), by the names of the joints."""
    position, velocity, efforts = message.position, message.velocity, message.effort
    if len(position) != len(JOINTS) or len(velocity) != len(JOINTS):
        raise RefusedError(
            f"needs position and velocity of {JOINTS}, given {len(position)} positions and "
            f"{len(velocity)} velocities"
        )
    if len(efforts) not in (0, len(JOINTS)):
        raise RefusedError(f"needs effort of {JOINTS} or none, given {len(efforts)}")
    arm, pendulum = 0, 1
    if message.name != JOINTS:
        if len(message.name) != len(JOINTS) or sorted(message.name) != JOINTS:
            given = shortened(list(message.name))
            raise RefusedError(f"joint names must be {JOINTS}, given {given}")
        arm, pendulum = 1, 0
    effort = efforts[arm] if efforts else nan
    return position[arm], velocity[arm], position[pendulum], velocity[pendulum], effort
