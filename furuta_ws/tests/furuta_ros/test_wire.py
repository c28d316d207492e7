"""The usual layout is read as the middleware reads it."""

from array import array
from contextlib import suppress
from math import inf, nan
from struct import pack

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from furuta_ros.messages import NAMES, RefusedError, deserialized, read_value
from furuta_ros.time_stamps import stamp_nanoseconds
from furuta_ros.wire import joint_state_bytes, unpack_joint_state, value_bytes

numbers = st.lists(st.floats(), max_size=3)


def joint_state(
    names: list[str],
    position: list[float],
    velocity: list[float],
    effort: list[float],
    frame: str = "",
    sec: int = 0,
    nanosec: int = 0,
) -> JointState:
    message = JointState(name=names)
    message.position, message.velocity = array("d", position), array("d", velocity)
    message.effort = array("d", effort)
    message.header.frame_id = frame
    message.header.stamp.sec, message.header.stamp.nanosec = sec, nanosec
    return message


messages = st.builds(
    joint_state,
    st.sampled_from([NAMES[::-1], ["arm"], ["arm", "pendulum2"], []]) | st.just(NAMES),
    numbers | st.lists(st.floats(), min_size=2, max_size=2),
    numbers | st.lists(st.floats(), min_size=2, max_size=2),
    numbers | st.lists(st.floats(), min_size=2, max_size=2),
    st.sampled_from(["", "", "base"]),
    st.integers(-(2**31), 2**31 - 1),
    st.integers(0, 2**32 - 1),
)


def bits(values: object) -> list[int]:
    return np.array(values, dtype=float).view(np.int64).tolist()


def assert_read_alike(data: bytes) -> bool:
    """Whatever is read in the usual layout, the middleware reads with the same numbers."""
    read = unpack_joint_state(data)
    if read is None:
        return False
    message = deserialize_message(data, JointState)
    assert message.name == NAMES
    (arm, pendulum), (arm_speed, pendulum_speed) = message.position, message.velocity
    stamp, x = read
    assert bits(x) == bits([arm, arm_speed, pendulum, pendulum_speed, message.effort[0]])
    assert stamp == stamp_nanoseconds(message)
    return True


@settings(deadline=None)
@given(messages)
def test_messages_of_every_shape(message: JointState) -> None:
    """The usual shape is read; any other is left to the middleware."""
    usual = (
        message.name == NAMES
        and not message.header.frame_id
        and all(len(v) == 2 for v in (message.position, message.velocity, message.effort))
    )
    # The middleware does not clear the bytes between the fields.
    assert assert_read_alike(bytes(serialize_message(message))) <= usual


@settings(deadline=None, max_examples=1000)
@given(messages, st.integers(0, 200), st.binary(max_size=9), st.integers(0, 9))
def test_changed_messages_are_read_as_the_middleware_reads_them(
    message: JointState, at: int, new: bytes, removed: int
) -> None:
    """What the middleware refuses is refused with a reason."""
    data = bytes(serialize_message(message))
    changed = data[:at] + new + data[at + removed :]
    assert_read_alike(changed)
    with suppress(RefusedError):
        deserialized(changed, JointState)


@settings(deadline=None)
@given(st.lists(st.floats(), min_size=5, max_size=5), st.integers(0, 2**31 * 10**9 - 1))
def test_the_middleware_reads_what_is_written(values: list[float], stamp: int) -> None:
    """The written message is the middleware's own, but for the bytes between its fields."""
    phi, phi_dot, theta, theta_dot, effort = values
    data = joint_state_bytes(stamp, tuple(values))
    assert assert_read_alike(data)
    typed = deserialize_message(data, JointState)
    expected = joint_state(NAMES, [phi, theta], [phi_dot, theta_dot], [effort, 0.0])
    expected.header.stamp.sec, expected.header.stamp.nanosec = divmod(stamp, 10**9)
    fields = ("position", "velocity", "effort")
    assert [bits(getattr(typed, f)) for f in fields] == [bits(getattr(expected, f)) for f in fields]
    assert (typed.header, typed.name) == (expected.header, expected.name)
    assert len(serialize_message(expected)) == len(data)


@given(st.floats(-1e6, 1e6))
def test_values_in_and_out(value: float) -> None:
    """A Float64 in either layout of the middleware."""
    data = value_bytes(value)
    assert data == bytes(serialize_message(Float64(data=value)))
    for each in (data, pack(">4Bd", 0, 0, 0, 0, value), data + b"\0"):
        assert bits(read_value(each)) == bits(value)


TRUNCATED = b"", b"\0\1\0\0", b"\0\1\0\0" + b"\0" * 7
IMPOSSIBLE = (bytes(serialize_message(Float64(data=value))) for value in (nan, -inf, 1e300))


@pytest.mark.parametrize("data", [*TRUNCATED, b"\xff" * 12, *IMPOSSIBLE])
def test_what_is_no_value_is_refused(data: bytes) -> None:
    """Too short, in no known encoding, not finite, too large."""
    with pytest.raises(RefusedError):
        read_value(data)
