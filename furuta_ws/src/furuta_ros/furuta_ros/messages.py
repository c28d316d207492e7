"""Conversion between messages and the arrays of the cores.

A state is an array in the order x = (φ, φ̇, θ, θ̇), followed by the arm's effort. Readers
validate messages and raise :class:`RefusedError` for invalid ones. Writers reuse their message,
which is safe because publishing copies it.
"""

from array import array
from collections.abc import Sequence
from math import isnan, nan

import numpy as np
from sensor_msgs.msg import JointState

from furuta_model.parameters import shortened
from furuta_model.state import EFFORT, LARGEST_VALUE, PHI, PHI_DOT, THETA, THETA_DOT
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import JOINTS


class RefusedError(ValueError):
    """A message is invalid; the error says why."""


def read_joints(message: JointState, x: np.ndarray, partly: bool = False) -> None:
    """Write the message's state and the arm's effort to ``x`` (5,).

    The effort may be unknown (NaN); with ``partly`` so may the other values.

    Raises:
        RefusedError: The message is invalid; ``x`` is unchanged.
    """
    phi, phi_dot, theta, theta_dot, effort = _values(message)
    if not abs(phi) + abs(phi_dot) + abs(theta) + abs(theta_dot) <= LARGEST_VALUE:
        for value in (phi, phi_dot, theta, theta_dot):
            if abs(value) > LARGEST_VALUE or (isnan(value) and not partly):
                raise RefusedError(
                    f"values must be finite and at most {LARGEST_VALUE:g}, given position "
                    f"{list(message.position)}, velocity {list(message.velocity)}"
                )
    if abs(effort) > LARGEST_VALUE:
        raise RefusedError(f"effort must be at most {LARGEST_VALUE:g}, given {effort}")
    x[PHI], x[PHI_DOT], x[THETA], x[THETA_DOT] = phi, phi_dot, theta, theta_dot
    x[EFFORT] = effort


def read_measurement(message: JointState, measurement: np.ndarray) -> None:
    """Write the message's readings and the arm's effort to ``measurement`` (5,), whatever they are.

    The estimator decides which readings it can use.

    Raises:
        RefusedError: The message is invalid; ``measurement`` is unchanged.
    """
    phi, phi_dot, theta, theta_dot, effort = _values(message)
    measurement[PHI], measurement[PHI_DOT] = phi, phi_dot
    measurement[THETA], measurement[THETA_DOT] = theta, theta_dot
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


class JointWriter:
    """A JointState message that is reused for every sample."""

    def __init__(self) -> None:
        self.message = JointState(
            name=JOINTS,
            position=array("d", (0.0, 0.0)),
            velocity=array("d", (0.0, 0.0)),
            effort=array("d", (0.0, 0.0)),
        )
        # The setters may have copied what they were given.
        self._position = self.message.position
        self._velocity = self.message.velocity
        self._effort = self.message.effort

    def fill(self, x: Sequence[float] | np.ndarray, effort: float) -> JointState:
        """Write state ``x`` (4 or more) and the arm's effort [V]."""
        # Python floats: numpy scalars take several times as long to assign.
        values = x.tolist() if isinstance(x, np.ndarray) else x
        self._position[0], self._position[1] = values[PHI], values[THETA]
        self._velocity[0], self._velocity[1] = values[PHI_DOT], values[THETA_DOT]
        self._effort[0] = effort
        return self.message

    def stamp(self, nanoseconds: int) -> None:
        """Set the time stamp."""
        stamp = self.message.header.stamp
        stamp.sec, stamp.nanosec = divmod(nanoseconds, NANOSECONDS)
