"""Compiled code reads serialised messages as the middleware does, and never beyond them.

FURUTA_MUTATIONS sets the number of mutated messages.
"""

import os
import random
import subprocess
import sys
from array import array
from math import inf, nan
from struct import pack

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from furuta_model.compiled import compiled
from furuta_ros.messages import RefusedError, deserialized, read_value
from furuta_ros.time_stamps import stamp_nanoseconds
from furuta_ros.topics import JOINTS
from furuta_ros.wire import (
    ANEW,
    CONTINUES,
    REPEATED,
    UNUSUAL,
    new_float64,
    new_joint_state,
    take_joint_state,
    write_joint_state,
)

MUTATIONS = int(os.environ.get("FURUTA_MUTATIONS", "10000"))
NO_STAMP = -(2**62)

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
    st.sampled_from([JOINTS[::-1], ["arm"], ["arm", "pendulum2"], []]) | st.just(JOINTS),
    numbers | st.lists(st.floats(), min_size=2, max_size=2),
    numbers | st.lists(st.floats(), min_size=2, max_size=2),
    numbers | st.lists(st.floats(), min_size=2, max_size=2),
    st.text(st.characters(min_codepoint=1, max_codepoint=127), max_size=9),
    st.integers(-(2**31), 2**31 - 1),
    st.integers(0, 2**32 - 1),
)


@compiled
def take(data: bytes, previous: int, bounded: bool, x: np.ndarray) -> tuple[int, int]:
    return take_joint_state(data, previous, bounded, x)


@compiled
def write(message: np.ndarray, stamp: int, x: np.ndarray, effort: float) -> None:
    write_joint_state(message[0], stamp, x, effort)


def bits(values: object) -> list[int]:
    return np.array(values, dtype=float).view(np.int64).tolist()


def assert_read_alike(data: bytes) -> int:
    """Whatever the compiled reader takes, the middleware takes with the same numbers."""
    x = np.full(5, 7.0)
    sample, stamp = take(data, NO_STAMP, False, x)
    if sample == UNUSUAL:
        assert (stamp, x.tolist()) == (NO_STAMP, [7.0] * 5)
        return UNUSUAL
    message = deserialize_message(data, JointState)
    assert message.name == JOINTS
    (arm, pendulum), (arm_speed, pendulum_speed) = message.position, message.velocity
    expected = [arm, arm_speed, pendulum, pendulum_speed, message.effort[0]]
    assert bits(x) == bits(expected)
    assert stamp == stamp_nanoseconds(message)
    return int(sample)


@settings(deadline=None)
@given(messages)
def test_messages_of_every_shape(message: JointState) -> None:
    """The usual shape is read; any other is left to the typed path."""
    usual = message.name == JOINTS and all(
        len(values) == 2 for values in (message.position, message.velocity, message.effort)
    )
    assert (assert_read_alike(bytes(serialize_message(message))) != UNUSUAL) == usual


def test_mutated_messages_are_read_as_the_middleware_reads_them() -> None:
    """FURUTA_MUTATIONS of them; what the middleware refuses is refused with a reason."""
    chance = random.Random(1)
    originals = [
        bytes(serialize_message(joint_state(names, [1.0] * n, [2.0] * n, [3.0] * m, frame, 5, 6)))
        for names in (JOINTS, JOINTS[::-1], ["arm"])
        for n, m in ((2, 2), (2, 0), (3, 2), (0, 0))
        for frame in ("", "base")
    ]
    taken = refused = 0
    for _ in range(MUTATIONS):
        data = mutated(chance.choice(originals[: chance.choice((2, len(originals)))]), chance)
        taken += assert_read_alike(data) != UNUSUAL
        try:
            deserialized(data, JointState)
        except RefusedError:
            refused += 1
    assert taken > MUTATIONS // 20
    assert refused > MUTATIONS // 50


def mutated(original: bytes, chance: random.Random) -> bytes:
    """Some bytes changed, or the end cut off, or bytes added."""
    data = bytearray(original)
    kind = chance.random()
    if kind < 0.5:
        for _ in range(chance.randint(1, 4)):
            data[chance.randrange(len(data))] = chance.choice(
                (0, 1, 2, 4, 255, chance.getrandbits(8))
            )
    elif kind < 0.75:
        del data[chance.randrange(len(data)) :]
    else:
        data += chance.randbytes(chance.randrange(9))
    return bytes(data)


@pytest.mark.parametrize(
    ("stamp", "sample"),
    [(10**9, REPEATED), (10**9 + 1, CONTINUES), (10**9 - 1, ANEW), (2 * 10**9, ANEW)],
)
def test_what_a_sample_is_follows_from_its_stamp(stamp: int, sample: int) -> None:
    """A repeated one is not read."""
    message = new_joint_state()
    write(message, stamp, np.ones(5), 1.0)
    x = np.zeros(5)
    assert take(message.tobytes(), 10**9, True, x) == (sample, stamp)
    assert x.tolist() == [float(sample != REPEATED)] * 5


@pytest.mark.parametrize("index", range(5))
def test_an_impossible_value_is_unusual_and_a_nan_is_not(index: int) -> None:
    """The typed path says what is wrong with it."""
    message, x = new_joint_state(), np.zeros(5)
    for value, usual in ((1e300, False), (nan, True)):
        given_x = np.zeros(5)
        given_x[index] = value
        write(message, 1, given_x, given_x[4])
        assert (take(message.tobytes(), 0, True, x)[0] != UNUSUAL) == usual
        assert take(message.tobytes(), 0, False, x)[0] != UNUSUAL


@settings(deadline=None)
@given(st.lists(st.floats(), min_size=5, max_size=5), st.integers(0, 2**31 * 10**9 - 1))
def test_the_middleware_reads_what_is_written(values: list[float], stamp: int) -> None:
    """The written message is the middleware's own, but for the bytes between its fields."""
    message = new_joint_state()
    write(message, stamp, np.array(values), values[4])
    phi, phi_dot, theta, theta_dot, effort = values
    typed = deserialize_message(message.tobytes(), JointState)
    expected = joint_state(JOINTS, [phi, theta], [phi_dot, theta_dot], [effort, 0.0])
    expected.header.stamp.sec, expected.header.stamp.nanosec = divmod(stamp, 10**9)
    fields = ("position", "velocity", "effort")
    assert [bits(getattr(typed, f)) for f in fields] == [bits(getattr(expected, f)) for f in fields]
    assert (typed.header, typed.name) == (expected.header, expected.name)
    assert len(serialize_message(expected)) == len(message.tobytes())


@given(st.floats(-1e6, 1e6))
def test_values_in_and_out(value: float) -> None:
    """A Float64 in either layout of the middleware."""
    message = new_float64()
    message["value"] = value
    assert message.tobytes() == bytes(serialize_message(Float64(data=value)))
    for data in (message.tobytes(), pack(">4Bd", 0, 0, 0, 0, value), message.tobytes() + b"\0"):
        assert bits(read_value(data)) == bits(value)


TRUNCATED = b"", b"\0\1\0\0", b"\0\1\0\0" + b"\0" * 7
IMPOSSIBLE = (bytes(serialize_message(Float64(data=value))) for value in (nan, -inf, 1e300))


@pytest.mark.parametrize("data", [*TRUNCATED, b"\xff" * 12, *IMPOSSIBLE])
def test_what_is_no_value_is_refused(data: bytes) -> None:
    """Too short, in no known encoding, not finite, too large."""
    with pytest.raises(RefusedError):
        read_value(data)


def test_nothing_is_read_beyond_the_message() -> None:
    """Without compilation such a read is an error."""
    command = (sys.executable, "-m", "pytest", "-q", "-k", "not beyond", __file__)
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "FURUTA_MUTATIONS": "5000"}
    subprocess.run(command, env=environment, check=True)
