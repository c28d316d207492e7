"""Reads what a bag holds of the graph, one row per measurement."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from rosbags.interfaces import Connection

from furuta_model.parameters import ParameterError
from furuta_model.state import EFFORT, RIGID_STATES, SIGNALS
from furuta_recordings.bags.bag import Bag, last_part
from furuta_recordings.bags.series import Series, read_series
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import (
    COMMAND,
    FRICTION_ESTIMATE,
    GROUND_TRUTH,
    JOINT_STATES,
    JOINTS,
    MEASUREMENT,
    TOPICS,
)

# Topics without a stamp, and the types of all; a bag with other types is of another rig.
NUMBERS = (FRICTION_ESTIMATE.name, COMMAND.name)
TYPES = {topic.name: topic.type for topic in TOPICS}


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


def graph_topics(path: Path, bag: Bag) -> list[Connection]:
    """The topics of the graph in a bag; none in the bag of another rig."""
    topics = [topic for topic in bag.connections if last_part(topic.topic) in TYPES]
    measured = {topic.topic for topic in topics if last_part(topic.topic) == MEASUREMENT.name}
    if len(measured) > 1:
        raise ParameterError(f"{path} holds several graphs: {', '.join(sorted(measured))}")
    usual = all(TYPES[last_part(topic.topic)] == topic.msgtype for topic in topics)
    return topics if measured and usual else []


def read_recorded_loop(path: Path) -> RecordedLoop:
    """Read a bag of the graph, sample by sample; repeated measurements are ignored."""
    with Bag(path) as bag:
        topics = [topic.topic for topic in graph_topics(path, bag)]
        series = dict.fromkeys(TYPES, Series())
        series |= {last_part(name): each for name, each in read_series(bag, topics).items()}
    measured = series[MEASUREMENT.name]
    if not len(measured.stamps):
        raise ParameterError(f"{path}: no message on {MEASUREMENT.name} of the graph")
    first = np.sort(np.unique(measured.stamps, return_index=True)[1])
    stamps = measured.stamps[first]
    return RecordedLoop(
        stamps,
        measured.arrivals[first],
        _signals(measured)[first],
        _at(stamps, series[JOINT_STATES.name]),
        _at(stamps, series[GROUND_TRUTH.name]),
        {name: (series[name].arrivals, series[name].values) for name in NUMBERS},
    )


def _signals(series: Series) -> np.ndarray:
    """φ, φ̇, θ, θ̇ and the arm's effort (n, 5) in joint states."""
    arm, pendulum = (series.joint(name) for name in JOINTS)
    return np.column_stack([arm[:, :2], pendulum[:, :2], arm[:, 2]])


def _at(stamps: np.ndarray, series: Series) -> np.ndarray:
    """The signals (n, 5) of the messages with these stamps."""
    rows = {stamp: row for row, stamp in enumerate(series.stamps.tolist())}
    chosen = [rows.get(stamp, -1) for stamp in stamps.tolist()]  # -1: the row without values
    return np.vstack([_signals(series), np.full(SIGNALS, np.nan)])[chosen]


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
    numbers = (loop.at_measurements(topic) for topic in NUMBERS)
    return RecordedRun(loop.stamps / NANOSECONDS, state, friction, *numbers)
