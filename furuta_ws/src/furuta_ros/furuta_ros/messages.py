"""Reads messages of the loop that the middleware must read, and values of Float64.

See :mod:`furuta_ros.wire` for the usual layout.
"""

from math import nan
from typing import Any

from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from furuta_model.parameters import shortened
from furuta_model.state import LARGEST_VALUE
from furuta_ros.time_stamps import stamp_nanoseconds
from furuta_ros.topics import JOINTS
from furuta_ros.wire import ENCODING, FLOAT64, Signals

NAMES = list(JOINTS)


class RefusedError(ValueError):
    """A message is invalid; the error says why."""


def typed_joint_state(data: bytes) -> tuple[int, Signals]:
    """Stamp [ns] and signals of a JointState in any layout, by the names of the joints.

    Raises:
        RefusedError: It is none, or has no position and velocity of both joints. An effort that is
            not given is NaN.
    """
    message: JointState = deserialized(data, JointState)
    position, velocity, efforts = message.position, message.velocity, message.effort
    if len(position) != len(NAMES) or len(velocity) != len(NAMES):
        raise RefusedError(
            f"needs position and velocity of {NAMES}, given {len(position)} positions and "
            f"{len(velocity)} velocities"
        )
    if len(efforts) not in (0, len(NAMES)):
        raise RefusedError(f"needs effort of {NAMES} or none, given {len(efforts)}")
    if sorted(message.name) != NAMES:
        given = shortened(list(message.name))
        raise RefusedError(f"joint names must be {NAMES}, given {given}")
    arm, pendulum = map(message.name.index, NAMES)
    of_arm, of_pendulum = (position[arm], velocity[arm]), (position[pendulum], velocity[pendulum])
    return stamp_nanoseconds(message), (*of_arm, *of_pendulum, efforts[arm] if efforts else nan)


def joint_numbers(data: bytes, joint: str) -> tuple[int, list[float]] | None:
    """Stamp [ns], position, velocity and effort of a joint in a JointState; NaN if not given.

    None if the message says nothing of the joint, as another part of the robot may have sent it.
    Raises RefusedError if it is no JointState.
    """
    message: JointState = deserialized(data, JointState)
    if joint not in message.name:
        return None
    index = message.name.index(joint)
    series = message.position, message.velocity, message.effort
    numbers = [float(each[index]) if index < len(each) else nan for each in series]
    return stamp_nanoseconds(message), numbers


def value_of(data: bytes) -> float:
    """The value of a serialised Float64. Raises RefusedError if it is none."""
    if len(data) == FLOAT64.size and data.startswith(ENCODING):
        value: float = FLOAT64.unpack(data)[1]
        return value
    return float(deserialized(data, Float64).data)


def read_value(data: bytes) -> float:
    """The value [V] of a serialised Float64, which must be finite and possible."""
    value = value_of(data)
    if not -LARGEST_VALUE <= value <= LARGEST_VALUE:
        raise RefusedError(f"data is {value}, must be finite and at most {LARGEST_VALUE:g}")
    return value


def deserialized(data: bytes, kind: Any) -> Any:
    """The message, as the middleware reads it. Raises RefusedError if it cannot."""
    try:
        return deserialize_message(data, kind)
    except Exception as error:  # the middleware's own kinds of error, which differ
        raise RefusedError(f"cannot be read: {error}") from None
