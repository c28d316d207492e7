"""Reads the messages of the loop, in their usual layout or in any that the middleware reads.

A signal array (5,) is the state x = (φ, φ̇, θ, θ̇), followed by the effort of the arm.
"""

from math import inf, nan
from typing import Any

import numpy as np
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from furuta_model.parameters import shortened
from furuta_model.state import EFFORT, LARGEST_VALUE, PHI, PHI_DOT, THETA, THETA_DOT
from furuta_ros.time_stamps import stamp_nanoseconds
from furuta_ros.topics import JOINTS
from furuta_ros.wire import unpack_joint_state, unpack_value


class RefusedError(ValueError):
    """A message is invalid; the error says why."""


def read_joint_state(data: bytes, x: np.ndarray, largest: float = inf) -> int:
    """Write the signals of a serialised JointState to ``x`` (5,); return its stamp [ns].

    NaN is an unknown value, as is an effort that is not given.

    Raises:
        RefusedError: It is none, or the values together exceed ``largest``; ``x`` is unchanged.
    """
    stamp, phi, phi_dot, theta, theta_dot, effort = unpack_joint_state(data) or _signals(
        deserialized(data, JointState)
    )
    if abs(phi) + abs(phi_dot) + abs(theta) + abs(theta_dot) + abs(effort) > largest:
        raise RefusedError(
            f"values must be finite and at most {largest:g} together, given position "
            f"{[phi, theta]}, velocity {[phi_dot, theta_dot]}, effort {effort}"
        )
    x[PHI], x[PHI_DOT], x[THETA], x[THETA_DOT], x[EFFORT] = phi, phi_dot, theta, theta_dot, effort
    return stamp


def _signals(message: JointState) -> tuple[int, float, float, float, float, float]:
    """Stamp [ns], φ, φ̇, θ, θ̇ and the effort of the arm, by the names of the joints."""
    position, velocity, efforts = message.position, message.velocity, message.effort
    if len(position) != len(JOINTS) or len(velocity) != len(JOINTS):
        raise RefusedError(
            f"needs position and velocity of {JOINTS}, given {len(position)} positions and "
            f"{len(velocity)} velocities"
        )
    if len(efforts) not in (0, len(JOINTS)):
        raise RefusedError(f"needs effort of {JOINTS} or none, given {len(efforts)}")
    if sorted(message.name) != JOINTS:
        given = shortened(list(message.name))
        raise RefusedError(f"joint names must be {JOINTS}, given {given}")
    arm, pendulum = map(message.name.index, JOINTS)
    stamp, effort = stamp_nanoseconds(message), efforts[arm] if efforts else nan
    return stamp, position[arm], velocity[arm], position[pendulum], velocity[pendulum], effort


def value_of(data: bytes) -> float:
    """The value of a serialised Float64. Raises RefusedError if it is none."""
    value = unpack_value(data)
    return float(deserialized(data, Float64).data) if value is None else value


def read_value(data: bytes) -> float:
    """The value [V] of a serialised Float64, which must be finite and possible."""
    value = value_of(data)
    if not abs(value) <= LARGEST_VALUE:
        raise RefusedError(f"data is {value}, must be finite and at most {LARGEST_VALUE:g}")
    return value


def deserialized(data: bytes, kind: Any) -> Any:
    """The message, as the middleware reads it. Raises RefusedError if it cannot."""
    try:
        return deserialize_message(data, kind)
    except Exception as error:  # the middleware's own kinds of error, which differ
        raise RefusedError(f"cannot be read: {error}") from None
