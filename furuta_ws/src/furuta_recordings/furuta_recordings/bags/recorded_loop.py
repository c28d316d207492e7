"""Reads what a bag holds of the graph, one row per measurement."""

from __future__ import annotations

from array import array
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_model.state import EFFORT, RIGID_STATES, SIGNALS
from furuta_recordings.bags.bag import Bag, Topic, last_part
from furuta_ros.time_stamps import NANOSECONDS, stamp_nanoseconds
from furuta_ros.topic_names import (
    COMMAND,
    FRICTION_ESTIMATE,
    GROUND_TRUTH,
    JOINT_STATES,
    MEASUREMENT,
)
from furuta_ros.wire import Signals, unpack_joint_state

JOINT_STATE_TYPE = "sensor_msgs/msg/JointState"
# Topics of the graph with and without a stamp, and their types; a bag with other types is of
# another rig.
STAMPED = (MEASUREMENT, JOINT_STATES, GROUND_TRUTH)
NUMBERS = (FRICTION_ESTIMATE, COMMAND)
TYPES = {
    **dict.fromkeys(STAMPED, JOINT_STATE_TYPE),
    **dict.fromkeys(NUMBERS, "std_msgs/msg/Float64"),
}


class RecordedLoop(NamedTuple):
    """What a bag holds of the graph, one row per measurement, NaN where nothing was recorded.

    ``stamps`` and ``arrivals`` (n,) [ns]; ``measurement``, ``estimate`` and ``truth`` (n, 5).
    ``numbers`` by topic: times of arrival (m,) [ns] and values (m,) of messages without a stamp.
    """

    stamps: np.ndarray
    arrivals: np.ndarray
    measurement: np.ndarray
    estimate: np.ndarray
    truth: np.ndarray
    numbers: dict[str, tuple[np.ndarray, np.ndarray]]

    @property
    def time(self) -> np.ndarray:
        """Time since the first sample (n,) [s]."""
        elapsed: np.ndarray = (self.stamps - self.stamps[0]) / NANOSECONDS
        return elapsed

    @property
    def friction_estimate(self) -> np.ndarray:
        """Friction estimates in their order (n,) [V]."""
        return self._in_order(FRICTION_ESTIMATE)

    @property
    def command(self) -> np.ndarray:
        """Commands in their order (n,) [V]."""
        return self._in_order(COMMAND)

    def _in_order(self, topic: str) -> np.ndarray:
        series = np.full(len(self.stamps), np.nan)
        _, values = self.numbers[topic]
        series[: len(values)] = values[: len(series)]
        return series

    def at_measurements(self, topic: str) -> np.ndarray:
        """The number at each measurement (n,).

        If there is one for each measurement they are taken in order, otherwise by the time at
        which they were recorded.
        """
        times, values = self.numbers[topic]
        if len(values) == len(self.stamps):
            return values
        series = np.full(len(self.stamps), np.nan)
        rows = np.searchsorted(self.arrivals, times, side="right") - 1
        series[rows[rows >= 0]] = values[rows >= 0]
        return series


def graph_topics(path: Path, bag: Bag) -> list[Topic]:
    """The topics of the graph in a bag; none in the bag of another rig."""
    topics = [topic for topic in bag.connections if last_part(topic.topic) in TYPES]
    measured = [topic.topic for topic in topics if last_part(topic.topic) == MEASUREMENT]
    if len(measured) > 1:
        raise ParameterError(f"{path} holds several graphs: {', '.join(sorted(measured))}")
    usual = all(TYPES[last_part(topic.topic)] == topic.msgtype for topic in topics)
    return topics if measured and usual else []


def read_recorded_loop(path: Path) -> RecordedLoop:
    """Read a bag of the graph, sample by sample; repeated measurements are ignored."""
    rows: dict[int, int] = {}  # numbers of the samples by the stamp [ns]
    arrivals = array("q")
    # Stamps or times of arrival [ns], and what the messages hold.
    series = {name: (array("q"), array("d")) for name in (*STAMPED, *NUMBERS)}
    with Bag(path) as bag:
        topics = graph_topics(path, bag)
        for topic, time, data in bag.messages_in_memory(topics):
            name = last_part(topic.topic)
            times, values = series[name]
            if name in NUMBERS:
                times.append(time)
                values.append(bag.deserialize(data, topic.msgtype).data)
                continue
            stamp, x = unpack_joint_state(data) or _signals(bag.deserialize(data, topic.msgtype))
            if name == MEASUREMENT and stamp in rows:
                continue
            if name == MEASUREMENT:
                rows[stamp] = len(rows)
                arrivals.append(time)
            times.append(stamp)
            values.extend(x)
    if not rows:
        raise ParameterError(f"{path}: no message on {MEASUREMENT} of the graph")
    measurement, estimate, truth = (_by_row(rows, *series[name]) for name in STAMPED)
    numbers = {name: (np.array(series[name][0]), np.array(series[name][1])) for name in NUMBERS}
    stamps = np.fromiter(rows, np.int64)
    return RecordedLoop(stamps, np.array(arrivals), measurement, estimate, truth, numbers)


def _signals(message: Any) -> tuple[int, Signals]:
    """Stamp [ns], φ, φ̇, θ, θ̇ and the arm's effort in the graph's joint states, or NaN."""
    (phi, theta), (phi_dot, theta_dot) = message.position, message.velocity
    effort = message.effort[0] if len(message.effort) else np.nan
    return stamp_nanoseconds(message), (phi, phi_dot, theta, theta_dot, effort)


def _by_row(rows: dict[int, int], stamps: array[int], values: array[float]) -> np.ndarray:
    """The signals (n, 5) of messages at the measurements with their stamps."""
    # Messages without a measurement go to the last row, which is dropped.
    result = np.full((len(rows) + 1, SIGNALS), np.nan)
    chosen = [rows.get(stamp, len(rows)) for stamp in stamps]
    result[chosen] = np.array(values).reshape(-1, SIGNALS)
    return result[: len(rows)]


class RecordedRun(NamedTuple):
    """Ground truth, friction estimate and command of a lock-step run.

    ``time`` (n,) [s], true ``state`` (n, 4), true ``friction`` (n,) [V], ``friction_estimate``
    (n,) [V], ``command`` (n,) [V].
    """

    time: np.ndarray
    state: np.ndarray
    friction: np.ndarray
    friction_estimate: np.ndarray
    command: np.ndarray

    def between(self, start: float, end: float) -> RecordedRun:
        """The samples with start ≤ time < end."""
        chosen = (self.time >= start - 1e-9) & (self.time < end - 1e-9)
        return RecordedRun(*(series[chosen] for series in self))


def read_recorded_run(path: Path) -> RecordedRun:
    """Read a lock-step recording with ground truth."""
    loop = read_recorded_loop(path)
    state, friction = loop.truth[:, :RIGID_STATES], loop.truth[:, EFFORT]
    time = loop.stamps / NANOSECONDS
    return RecordedRun(time, state, friction, loop.friction_estimate, loop.command)
