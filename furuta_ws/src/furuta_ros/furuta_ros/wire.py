"""The wire layout (CDR) of the loop's two message types: a sample that is never unpacked.

A serialised message begins with four bytes that name its encoding. Its fields follow in order, each
aligned to its own size. A string is its length with the final zero (uint32) and its bytes; a list
is its length (uint32) and its elements.

* ``Float64``: one double.
* ``JointState``: stamp (int32 s, uint32 ns), frame (string), names (list of strings), and the lists
  of doubles position, velocity and effort.

Messages are written into one prepared layout, :data:`JOINT_STATE` or :data:`FLOAT64`. The readers
for compiled code take that layout with any frame. They check every length before they read. To
anything else, such as another byte order, they answer :data:`UNUSUAL`; the middleware reads it.
"""

from typing import Any, Final

import numpy as np

from furuta_model.block import records
from furuta_model.compiled import inlined
from furuta_model.elementary import double_of_bits
from furuta_model.state import EFFORT, LARGEST_VALUE, PHI, PHI_DOT, THETA, THETA_DOT
from furuta_ros.time_stamps import NANOSECONDS, starts_anew

# Bytes before the fields; alignment counts from there.
HEADER: Final = 4
LITTLE_ENDIAN: Final = b"\0\1\0\0"

FLOAT64 = np.dtype([("header", "u1", 4), ("value", "<f8")])
JOINT_STATE = np.dtype(
    [
        ("header", "u1", 4),
        ("sec", "<i4"),
        ("nanosec", "<u4"),
        ("frame", "u1", 8),
        ("names", "u1", 28),
        ("positions", "<u4"),
        ("position", "<f8", 2),
        ("velocities", "<u4"),
        ("before_velocity", "u1", 4),
        ("velocity", "<f8", 2),
        ("efforts", "<u4"),
        ("before_effort", "u1", 4),
        ("effort", "<f8", 2),
    ]
)
# The joints' names with their final zeros.
ARM, PENDULUM = np.frombuffer(b"arm\0", np.uint8), np.frombuffer(b"pendulum\0", np.uint8)

# What a message is to a node: no sample in the usual layout, the last sample again, one that
# continues the motion, one that does not.
UNUSUAL, REPEATED, CONTINUES, ANEW = range(4)


def new_float64() -> np.ndarray:
    """A serialised Float64 (1,), to be filled by compiled code."""
    message = records(FLOAT64)
    message["header"] = list(LITTLE_ENDIAN)
    return message


def new_joint_state() -> np.ndarray:
    """A serialised JointState (1,) of arm and pendulum, to be filled by compiled code."""
    message = records(JOINT_STATE)
    message["header"] = list(LITTLE_ENDIAN)
    message["frame"][0, 0] = 1  # an empty string
    message["names"] = list(b"\2\0\0\0\4\0\0\0arm\0\x09\0\0\0pendulum\0\0\0\0")
    message["positions"] = message["velocities"] = message["efforts"] = 2
    return message


@inlined
def write_joint_state(message: Any, stamp: int, x: np.ndarray, effort: float) -> None:
    """Write stamp [ns], state ``x`` (4 or more) and the arm's effort [V] into ``message[0]``."""
    message.sec = stamp // NANOSECONDS
    message.nanosec = stamp % NANOSECONDS
    message.position[0], message.position[1] = x[PHI], x[THETA]
    message.velocity[0], message.velocity[1] = x[PHI_DOT], x[THETA_DOT]
    message.effort[0] = effort


@inlined
def take_joint_state(data: bytes, previous: int, bounded: bool, x: np.ndarray) -> tuple[int, int]:
    """Read a serialised JointState; return what it is, and its stamp [ns].

    The state and the arm's effort are written to ``x`` (5,), unless the message is unusual or has
    the stamp ``previous`` [ns] of the last one. With ``bounded`` an impossible value makes it
    unusual; NaN is a value that is not known.
    """
    position = _pair(data, _after_names(data))
    velocity = _pair(data, position + 16) if position > 0 else 0
    effort = _pair(data, velocity + 16) if velocity > 0 else 0
    if effort == 0:
        return UNUSUAL, previous
    seconds = _word(data, HEADER)
    stamp = (seconds - (seconds >> 31 << 32)) * NANOSECONDS + _word(data, HEADER + 4)
    if stamp == previous:
        return REPEATED, stamp
    phi, theta = _number(data, position), _number(data, position + 8)
    phi_dot, theta_dot = _number(data, velocity), _number(data, velocity + 8)
    torque = _number(data, effort)
    if bounded:
        for value in (phi, phi_dot, theta, theta_dot, torque):
            if abs(value) > LARGEST_VALUE:
                return UNUSUAL, previous
    x[PHI], x[PHI_DOT], x[THETA], x[THETA_DOT], x[EFFORT] = phi, phi_dot, theta, theta_dot, torque
    return (ANEW if starts_anew(previous, stamp) else CONTINUES), stamp


@inlined
def _after_names(data: bytes) -> int:
    """Where the list of positions stands, behind the joints' usual names; 0 if there is none."""
    if len(data) < HEADER + 12 or data[0] != 0 or data[1] != 1:
        return 0
    frame = _word(data, HEADER + 8)
    if frame > len(data):
        return 0
    at = _aligned(HEADER + 12 + frame, 4)
    if at + 4 > len(data) or _word(data, at) != 2:
        return 0
    after_arm = _aligned(_after_name(data, at + 4, ARM), 4)
    return _aligned(_after_name(data, after_arm, PENDULUM), 4)


@inlined
def _after_name(data: bytes, at: int, name: np.ndarray) -> int:
    """Where the string ``name`` at ``at`` ends; behind the message if there is another one."""
    if at + 4 + len(name) > len(data) or _word(data, at) != len(name):
        return len(data)
    for i in range(len(name)):
        if data[at + 4 + i] != name[i]:
            return len(data)
    return at + 4 + len(name)


@inlined
def _pair(data: bytes, at: int) -> int:
    """Where the two doubles of a list at ``at`` stand; 0 if it has no two."""
    if at == 0 or at + 4 > len(data) or _word(data, at) != 2:
        return 0
    first = _aligned(at + 4, 8)
    return first if first + 16 <= len(data) else 0


@inlined
def _aligned(at: int, size: int) -> int:
    """``at`` or the next multiple of ``size`` behind the header."""
    return at + (HEADER - at) % size


@inlined
def _word(data: bytes, at: int) -> Any:
    """The uint32 at ``at``; the bytes must be there."""
    first, second, third, fourth = data[at], data[at + 1], data[at + 2], data[at + 3]
    return np.int64(first) | np.int64(second) << 8 | np.int64(third) << 16 | np.int64(fourth) << 24


@inlined
def _number(data: bytes, at: int) -> float:
    """The double at ``at``; the bytes must be there."""
    return double_of_bits(_word(data, at) | _word(data, at + 4) << 32)
