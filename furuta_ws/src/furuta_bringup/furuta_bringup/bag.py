"""Reading recordings of the graph."""

from __future__ import annotations

import sqlite3
import struct
import zlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from rosbags.highlevel import AnyReader
from rosbags.highlevel.anyreader import AnyReaderError
from rosbags.interfaces import Connection
from rosbags.rosbag2 import ReaderError
from rosbags.typesys import Stores, get_typestore

from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, RIGID_STATES, THETA, THETA_DOT
from furuta_ros.messages import NANOSECONDS
from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, GROUND_TRUTH

# Messages of one topic that are read into memory at most: a quarter of an hour at 1 kHz.
LONGEST = 1_000_000


@contextmanager
def open_bag(path: Path) -> Iterator[AnyReader]:
    """A reader of a bag of any origin; what is wrong with it is said in one line."""
    if not path.exists():
        raise ParameterError(f"no bag {path}")
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_JAZZY)) as reader:
            yield reader
    except ParameterError:
        raise
    except UNREADABLE as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ParameterError(
            f"{path} is no readable bag: {reason} (`furuta bag recover` mends what it can)"
        ) from None


# What reading a bag that is not one, or not a whole one, ends in.
UNREADABLE = (
    AnyReaderError,
    ReaderError,
    OSError,
    EOFError,
    ValueError,
    KeyError,
    TypeError,
    AssertionError,
    struct.error,
    sqlite3.Error,
    zlib.error,
)


def refuse_too_long(path: Path, connections: Iterable[Connection]) -> None:
    """Refuse what would not fit into memory, before any of it is read."""
    for each in connections:
        if each.msgcount > LONGEST:
            raise ParameterError(
                f"{path}: {each.msgcount} messages on {each.topic}, at most {LONGEST} can be "
                "computed with at a time; record shorter ones"
            )


class Course(NamedTuple):
    """What a lock-step run of the graph was in truth, one row per sample.

    ``time`` (n,) [s], true ``state`` (n, 4), true ``friction`` (n,) [V], ``friction_estimate``
    (n,) [V], ``command`` (n,) [V].
    """

    time: np.ndarray
    state: np.ndarray
    friction: np.ndarray
    friction_estimate: np.ndarray
    command: np.ndarray

    def between(self, start: float, end: float) -> Course:
        """The part with start ≤ time < end."""
        chosen = (self.time >= start - 1e-9) & (self.time < end - 1e-9)
        return Course(*(series[chosen] for series in self))


def read_course(path: Path) -> Course:
    """Read a lock-step recording with ground truth."""
    rows: list[tuple[float, ...]] = []
    floats: dict[str, list[float]] = {FRICTION_ESTIMATE.name: [], COMMAND.name: []}
    with open_bag(path) as reader:
        wanted = {GROUND_TRUTH.name, *floats}
        connections = [c for c in reader.connections if last_part(c.topic) in wanted]
        for connection, _, data in reader.messages(connections):
            message: Any = reader.deserialize(data, connection.msgtype)
            name = last_part(connection.topic)
            if name == GROUND_TRUTH.name:
                rows.append(_row(message))
            else:
                floats[name].append(message.data)
    samples = min(len(rows), *map(len, floats.values()))
    table = np.array(rows[:samples])
    return Course(
        table[:, 0],
        table[:, 1 : 1 + RIGID_STATES],
        table[:, -1],
        np.array(floats[FRICTION_ESTIMATE.name][:samples]),
        np.array(floats[COMMAND.name][:samples]),
    )


def last_part(topic: str) -> str:
    """The topic's name without its namespace."""
    return topic.rpartition("/")[2]


def _row(message: Any) -> tuple[float, ...]:
    """Time, state and friction of a ground truth message."""
    stamp = message.header.stamp
    x = [0.0] * RIGID_STATES
    x[PHI], x[THETA] = message.position
    x[PHI_DOT], x[THETA_DOT] = message.velocity
    return (stamp.sec + stamp.nanosec / NANOSECONDS, *x, message.effort[0])
