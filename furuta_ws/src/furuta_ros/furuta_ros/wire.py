"""The usual layout of the loop's two message types, which one ``struct`` each reads and writes.

A serialised message (CDR) is four bytes that name its encoding, then its fields, each aligned to
its own size; text and lists begin with their length. The middleware may leave anything between the
fields; such a message is one in another layout. This file needs no ROS.
"""

from struct import Struct
from typing import Final

from furuta_ros.time_stamps import NANOSECONDS

# Little-endian.
ENCODING: Final = b"\0\1\0\0"
# No frame, two names, and the length of the list of positions; that of the other lists.
_NAMES: Final = b"\1\0\0\0\0\0\0\0\2\0\0\0\4\0\0\0arm\0\t\0\0\0pendulum\0\0\0\0\2\0\0\0"
_TWO: Final = b"\2\0\0\0\0\0\0\0"
# JointState: encoding, s, ns, names; positions; length and velocities; length and efforts.
_JOINT_STATE: Final = Struct("<4siI40s2d8s2d8sd8x")
FLOAT64: Final = Struct("<4sd")

# φ, φ̇, θ, θ̇ and the arm's effort.
Signals = tuple[float, float, float, float, float]
NO_SIGNALS: Final[Signals] = (0.0, 0.0, 0.0, 0.0, 0.0)


def unpack_joint_state(data: bytes) -> tuple[int, Signals] | None:
    """Stamp [ns] and signals of a serialised JointState; None if the layout is another one."""
    if len(data) != _JOINT_STATE.size:
        return None
    encoding, sec, nanosec, names, phi, theta, two, phi_dot, theta_dot, too, effort = (
        _JOINT_STATE.unpack(data)
    )
    if encoding == ENCODING and names == _NAMES and two == too == _TWO:
        return sec * NANOSECONDS + nanosec, (phi, phi_dot, theta, theta_dot, effort)
    return None


def joint_state_bytes(stamp: int, x: Signals) -> bytes:
    """A serialised JointState of stamp [ns] and signals."""
    phi, phi_dot, theta, theta_dot, effort = x
    head = ENCODING, stamp // NANOSECONDS, stamp % NANOSECONDS, _NAMES
    return _JOINT_STATE.pack(*head, phi, theta, _TWO, phi_dot, theta_dot, _TWO, effort)


def value_bytes(value: float) -> bytes:
    """A serialised Float64."""
    return FLOAT64.pack(ENCODING, value)
