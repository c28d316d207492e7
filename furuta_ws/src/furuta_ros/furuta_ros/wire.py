"""The usual layout of the loop's two message types, which one ``struct`` each reads and writes.

A serialised message (CDR) is four bytes that name its encoding, then its fields, each aligned to
its own size; text and lists begin with their length. This file needs no ROS.
"""

from struct import Struct
from typing import Final

import numpy as np

from furuta_ros.time_stamps import NANOSECONDS

# Little-endian.
_ENCODING: Final = b"\0\1\0\0"
# An empty text, and two names.
_NO_FRAME: Final = b"\1\0\0\0\0"
_NAMES: Final = b"\2\0\0\0\4\0\0\0arm\0\t\0\0\0pendulum\0"
# JointState: encoding, s, ns, frame, names; then length and two positions, velocities, efforts.
_JOINT_STATE: Final = Struct("<4siI5s3x25s3xI2dI4x2dI4x2d")
_FLOAT64: Final = Struct("<4sd")


def unpack_joint_state(data: bytes) -> tuple[int, float, float, float, float, float] | None:
    """Stamp [ns], φ, φ̇, θ, θ̇ and the arm's effort; None if the layout is another one."""
    if len(data) != _JOINT_STATE.size:
        return None
    encoding, sec, nanosec, frame, names, k, phi, theta, n, phi_dot, theta_dot, m, effort, _ = (
        _JOINT_STATE.unpack(data)
    )
    is_usual = encoding == _ENCODING and frame == _NO_FRAME and names == _NAMES
    if not (is_usual and k == n == m == 2):
        return None
    return sec * NANOSECONDS + nanosec, phi, phi_dot, theta, theta_dot, effort


def joint_state_bytes(stamp: int, x: np.ndarray, effort: float) -> bytes:
    """A serialised JointState with the stamp [ns], the state ``x`` (4 or more) and an effort."""
    sec, nanosec = divmod(stamp, NANOSECONDS)
    phi, phi_dot, theta, theta_dot, *_ = x.tolist()
    head = _ENCODING, sec, nanosec, _NO_FRAME, _NAMES
    return _JOINT_STATE.pack(*head, 2, phi, theta, 2, phi_dot, theta_dot, 2, effort, 0.0)


def unpack_value(data: bytes) -> float | None:
    """The value of a Float64; None if the layout is another one."""
    if len(data) != _FLOAT64.size or not data.startswith(_ENCODING):
        return None
    value: float = _FLOAT64.unpack(data)[1]
    return value


def value_bytes(value: float) -> bytes:
    """A serialised Float64."""
    return _FLOAT64.pack(_ENCODING, value)
