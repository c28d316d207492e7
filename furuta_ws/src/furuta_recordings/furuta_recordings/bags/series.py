"""Reads the series that a bag holds of topics: joint states, and numbers."""

from __future__ import annotations

from array import array
from collections.abc import Iterable
from math import nan
from struct import unpack_from
from typing import Any, NamedTuple

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.bag import Bag
from furuta_ros.time_stamps import stamp_nanoseconds
from furuta_ros.topic_names import JOINTS
from furuta_ros.wire import unpack_joint_state

JOINT_STATE_TYPE = "sensor_msgs/msg/JointState"
# Most messages of one topic that are read into memory: a quarter of an hour at 1 kHz.
MOST_IN_MEMORY = 1_000_000


class _Joint(NamedTuple):
    """The messages that hold a joint, and its position, velocity and effort in them."""

    rows: array[int]
    values: array[float]


class Series:
    """The messages of a topic: stamps and times of arrival [ns], and what they hold.

    A stamp is 0 without one. A topic has either ``joints`` by name, or ``values``.
    """

    def __init__(self) -> None:
        self._stamps, self._arrivals = array("q"), array("q")
        self._values = array("d")
        self.joints: dict[str, _Joint] = {}

    @property
    def stamps(self) -> np.ndarray:
        """Stamps (n,) [ns]."""
        return np.array(self._stamps, np.int64)

    @property
    def arrivals(self) -> np.ndarray:
        """Times of arrival (n,) [ns]."""
        return np.array(self._arrivals, np.int64)

    @property
    def values(self) -> np.ndarray:
        """Numbers (n,)."""
        return np.array(self._values)

    def joint(self, name: str) -> np.ndarray:
        """Position, velocity and effort (n, 3) of a joint; NaN where a message lacks them."""
        series = np.full((len(self._stamps), 3), nan)
        if name in self.joints:
            rows, values = self.joints[name]
            series[np.array(rows, int)] = np.array(values).reshape(-1, 3)
        return series

    def add_joints(self, time: int, data: bytes, bag: Bag) -> None:
        """Add a message of joint states that arrived at ``time`` [ns]."""
        usual = unpack_joint_state(data)
        if usual is not None:  # read ten times as fast
            stamp, (phi, phi_dot, theta, theta_dot, effort) = usual
            (of_pendulum,) = unpack_from("<d", data, len(data) - 8)
            self._add_joint(JOINTS[0], (phi, phi_dot, effort))
            self._add_joint(JOINTS[1], (theta, theta_dot, of_pendulum))
        else:
            message = bag.deserialize(data, JOINT_STATE_TYPE)
            stamp = stamp_nanoseconds(message)
            for index, name in enumerate(message.name):
                self._add_joint(name, joint_numbers(message, index))
        self._stamps.append(stamp)
        self._arrivals.append(time)

    def _add_joint(self, name: str, numbers: Iterable[float]) -> None:
        if name not in self.joints:
            self.joints[name] = _Joint(array("q"), array("d"))
        rows, values = self.joints[name]
        rows.append(len(self._stamps))
        values.extend(numbers)

    def add_number(self, time: int, message: Any, topic: str) -> None:
        """Add a message with a number in ``data`` that arrived at ``time`` [ns]."""
        self._values.append(_number(message, topic))
        self._stamps.append(stamp_nanoseconds(message) if hasattr(message, "header") else 0)
        self._arrivals.append(time)


def read_series(bag: Bag, topics: Iterable[str]) -> dict[str, Series]:
    """The series of topics (full names), in the order of their messages.

    Raises:
        ParameterError: The bag is damaged, or a topic does not fit into memory.
    """
    series = {topic: Series() for topic in topics}
    chosen = [connection for connection in bag.connections if connection.topic in series]
    for topic in chosen:
        if topic.msgcount > MOST_IN_MEMORY:
            raise ParameterError(
                f"{bag.path}: {topic.msgcount} messages on {topic.topic}, at most "
                f"{MOST_IN_MEMORY} fit into memory; record shorter bags"
            )
    for connection, time, data in bag.messages(chosen):
        if connection.msgtype == JOINT_STATE_TYPE:
            series[connection.topic].add_joints(time, data, bag)
        else:
            message = bag.deserialize(data, connection.msgtype)
            series[connection.topic].add_number(time, message, connection.topic)
    return series


def joint_numbers(message: Any, index: int) -> list[float]:
    """Position, velocity and effort of a joint in a JointState message; NaN where not given."""
    series = message.position, message.velocity, message.effort
    return [float(each[index]) if index < len(each) else nan for each in series]


def _number(message: Any, topic: str) -> float:
    """The number in a message: its data, or the first element of an array."""
    value = getattr(message, "data", None)
    if value is None:
        raise ParameterError(
            f"{topic}: a command needs a number in `data`, {message.__msgtype__} has none"
        )
    if isinstance(value, (int, float)):
        return float(value)
    if not len(value):
        raise ParameterError(f"{topic}: a command message has an empty array")
    return float(value[0])
