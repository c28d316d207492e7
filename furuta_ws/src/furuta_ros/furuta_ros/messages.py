"""Conversion between messages and the arrays of the cores.

A state is an array (4,) in the order x = (φ, φ̇, θ, θ̇). Readers check all that comes from
outside and raise :class:`RefusedError`; writers reuse their message, which is safe because
publishing copies it.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from math import isfinite

import numpy as np
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT

from .topics import JOINTS

NANOSECONDS = 1_000_000_000


class RefusedError(ValueError):
    """A message that cannot be used, with the reason in words."""


def read_float(message: Float64) -> float:
    """The message's value, which must be finite."""
    value: float = message.data
    if not isfinite(value):
        raise RefusedError(f"data is {value}, must be finite")
    return value


def read_joints(message: JointState, x: np.ndarray, pendulum_speed_measured: bool = True) -> None:
    """Write the message's state to ``x`` (4,), which is untouched if the message is refused.

    Without ``pendulum_speed_measured`` the speed of the pendulum is not looked at.
    """
    position, velocity = message.position, message.velocity
    if len(position) != len(JOINTS) or len(velocity) != len(JOINTS):
        raise RefusedError(
            f"needs position and velocity of {JOINTS}, given {len(position)} positions and "
            f"{len(velocity)} velocities"
        )
    arm, pendulum = 0, 1
    if message.name != JOINTS:
        if sorted(message.name) != JOINTS:
            raise RefusedError(f"joint names must be {JOINTS}, given {list(message.name)}")
        arm, pendulum = 1, 0
    phi, theta, phi_dot = position[arm], position[pendulum], velocity[arm]
    theta_dot = velocity[pendulum]
    # A sum is finite only if its terms are.
    total = phi + theta + phi_dot + theta_dot if pendulum_speed_measured else phi + theta + phi_dot
    if not isfinite(total):
        raise RefusedError(
            f"values must be finite, given position {list(position)}, velocity {list(velocity)}"
        )
    x[PHI], x[PHI_DOT], x[THETA], x[THETA_DOT] = phi, phi_dot, theta, theta_dot


def stamp_nanoseconds(message: JointState) -> int:
    """The message's time stamp [ns]."""
    stamp = message.header.stamp
    return int(stamp.sec * NANOSECONDS + stamp.nanosec)


class JointWriter:
    """A JointState message that is filled anew for every sample."""

    def __init__(self, with_effort: bool = False) -> None:
        self._position = array("d", (0.0, 0.0))
        self._velocity = array("d", (0.0, 0.0))
        self._effort = array("d", (0.0, 0.0) if with_effort else ())
        self.message = JointState(
            name=JOINTS, position=self._position, velocity=self._velocity, effort=self._effort
        )
        # The setters may have copied what they were given.
        self._position = self.message.position
        self._velocity = self.message.velocity
        self._effort = self.message.effort

    def fill(self, x: Sequence[float] | np.ndarray, effort: float | None = None) -> JointState:
        """Write state ``x`` (4 or more) and the arm's effort [V]."""
        self._position[0], self._position[1] = x[PHI], x[THETA]
        self._velocity[0], self._velocity[1] = x[PHI_DOT], x[THETA_DOT]
        if effort is not None:
            self._effort[0] = effort
        return self.message

    def stamp(self, nanoseconds: int) -> None:
        """Set the time stamp."""
        stamp = self.message.header.stamp
        stamp.sec, stamp.nanosec = divmod(nanoseconds, NANOSECONDS)
