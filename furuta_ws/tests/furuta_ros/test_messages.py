"""Conversion of messages to arrays and back; bad messages are rejected before the core."""

from array import array
from math import isnan, nan

import pytest
from rclpy.serialization import serialize_message

from furuta_ros.messages import typed_joint_state
from furuta_ros.testing import joint_state
from furuta_ros.wire import Signals, unpack_joint_state

STATE = (0.1, -0.2, 0.3, -0.4)


def read(message: object) -> Signals:
    data = serialize_message(message)
    _, x = unpack_joint_state(data) or typed_joint_state(data)
    return x


def test_joints_are_found_by_name() -> None:
    """The order of the joints in a message does not matter."""
    message = joint_state(STATE, 0, ["pendulum", "arm"])
    message.effort = array("d", [0.5, 0.6])
    assert read(message) == (0.3, -0.4, 0.1, -0.2, 0.6)


@pytest.mark.parametrize("efforts", [[], [nan, 0.0]])
def test_missing_effort_is_nan(efforts: list[float]) -> None:
    """No effort is read as NaN."""
    message = joint_state(STATE, 0)
    message.effort = array("d", efforts)
    assert isnan(read(message)[4])
