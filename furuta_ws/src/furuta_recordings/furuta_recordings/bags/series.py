"""Reads the series that a bag holds of topics: joint states, and numbers."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterable, Iterator, Sequence
from math import isnan, nan
from struct import unpack_from
from typing import Any, NamedTuple

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.bag import Bag
from furuta_ros.time_stamps import stamp_nanoseconds
from furuta_ros.topics import JOINT_STATE, JOINTS
from furuta_ros.wire import unpack_joint_state

QUANTITIES = ("position", "velocity", "effort")
# Name of a joint, its position, velocity and effort, and whether the effort is only commanded.
Numbers = tuple[str, list[float], bool]
# Most messages of one topic that are read into memory: a quarter of an hour at 1 kHz.
MOST_IN_MEMORY = 1_000_000


class _Joint(NamedTuple):
    """The messages that hold a joint, and its position, velocity and effort in them."""

    rows: array[int]
    values: array[float]


class Series:
    """The messages of a topic: stamps and times of arrival [ns], and what they hold.

    A stamp is 0 without one. A topic has either ``joints`` by name, or ``values``. ``commanded``
    are joints whose effort is an output of a controller.
    """

    def __init__(self) -> None:
        self._stamps, self._arrivals = array("q"), array("q")
        self._values = array("d")
        self.joints: dict[str, _Joint] = {}
        self.commanded: set[str] = set()

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

    def of_joint(self, name: str) -> Series:
        """The messages that name a joint: others have the stamps of another publisher."""
        rows, values = self.joints[name]
        own = Series()
        own._stamps = array("q", self.stamps[rows])
        own._arrivals = array("q", self.arrivals[rows])
        own.joints[name] = _Joint(array("q", range(len(rows))), values)
        own.commanded = self.commanded & {name}
        return own

    def add_joints(self, time: int, data: bytes, type_name: str, bag: Bag) -> None:
        """Add a message of joint states that arrived at ``time`` [ns]."""
        usual = unpack_joint_state(data) if type_name == JOINT_STATE else None
        if usual is not None:  # read ten times as fast
            stamp, (phi, phi_dot, theta, theta_dot, effort) = usual
            (of_pendulum,) = unpack_from("<d", data, len(data) - 8)
            self._add_joint(JOINTS[0], (phi, phi_dot, effort))
            self._add_joint(JOINTS[1], (theta, theta_dot, of_pendulum))
        else:
            message = bag.deserialize(data, type_name)
            stamp = stamp_nanoseconds(message)
            for name, numbers, commanded in STATE_TYPES[type_name](message):
                self._add_joint(name, numbers)
                if commanded:
                    self.commanded.add(name)
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
        if connection.msgtype in STATE_TYPES:
            series[connection.topic].add_joints(time, data, connection.msgtype, bag)
        else:
            message = bag.deserialize(data, connection.msgtype)
            series[connection.topic].add_number(time, message, connection.topic)
    return series


def _joint_state(message: Any) -> Iterator[Numbers]:
    series = message.position, message.velocity, message.effort
    for index, name in enumerate(message.name):
        yield name, [_at(index, each) for each in series], False


def _dynamic(message: Any) -> Iterator[Numbers]:
    """The resources with a position; others are sensors or switches."""
    for name, interfaces in zip(message.joint_names, message.interface_values, strict=False):
        given = dict(zip(interfaces.interface_names, interfaces.values, strict=False))
        if QUANTITIES[0] in given:
            yield name, [float(given.get(each, nan)) for each in QUANTITIES], False


def _trajectory(message: Any) -> Iterator[Numbers]:
    """The measured point, which earlier releases call actual; its effort, or else the output."""
    points = [getattr(message, name, None) for name in ("feedback", "actual")]
    measured = next((point for point in points if point and len(point.positions)), None)
    if measured is None:
        return
    output = getattr(message, "output", None)
    commands = output.effort if output else ()
    for index, name in enumerate(message.joint_names):
        series = measured.positions, measured.velocities, measured.effort
        position, velocity, effort = (_at(index, each) for each in series)
        commanded = isnan(effort) and not isnan(_at(index, commands))
        yield name, [position, velocity, _at(index, commands) if commanded else effort], commanded


# What holds joint states, the usual type first; the others are of the package control_msgs.
STATE_TYPES: dict[str, Callable[[Any], Iterator[Numbers]]] = {
    JOINT_STATE: _joint_state,
    "control_msgs/msg/DynamicJointState": _dynamic,
    "control_msgs/msg/JointTrajectoryControllerState": _trajectory,
}


def _at(index: int, series: Sequence[float]) -> float:
    """The number of a joint; NaN where not given."""
    return float(series[index]) if index < len(series) else nan


def _number(message: Any, topic: str) -> float:
    """The number in a message: its data, or the only element of an array."""
    value = getattr(message, "data", None)
    if value is None:
        raise ParameterError(
            f"{topic}: a command needs a number in `data`, {message.__msgtype__} has none"
        )
    if isinstance(value, (int, float)):
        return float(value)
    if len(value) != 1:
        raise ParameterError(f"{topic}: a command needs one number, a message has {len(value)}")
    return float(value[0])
