"""Readers of messages into the arrays and numbers of the cores.

A state is an array in the order x = (φ, φ̇, θ, θ̇), followed by the arm's effort. Readers
validate messages and raise :class:`RefusedError` for invalid ones.
"""

from math import nan
from struct import unpack_from
from typing import Any

import numpy as np
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from furuta_model.parameters import shortened
from furuta_model.state import EFFORT, LARGEST_VALUE, PHI, PHI_DOT, THETA, THETA_DOT
from furuta_ros.topics import JOINTS
from furuta_ros.wire import FLOAT64, HEADER, LITTLE_ENDIAN


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


def deserialized(data: bytes, kind: Any) -> Any:
    """The message, as the middleware reads it. Raises RefusedError if it cannot."""
    try:
        return deserialize_message(data, kind)
    except Exception as error:  # the middleware's own kinds of error, which differ
        raise RefusedError(f"cannot be read: {error}") from None


def value_of(data: bytes) -> float:
    """The value of a serialised Float64. Raises RefusedError if it is none."""
    if len(data) == FLOAT64.itemsize and data.startswith(LITTLE_ENDIAN):
        (value,) = unpack_from("<d", data, HEADER)
        return float(value)
    return float(deserialized(data, Float64).data)


def read_value(data: bytes) -> float:
    """The value [V] of a serialised Float64, which must be finite and possible."""
    value = value_of(data)
    if not abs(value) <= LARGEST_VALUE:
        raise RefusedError(f"data is {value}, must be finite and at most {LARGEST_VALUE:g}")
    return value
