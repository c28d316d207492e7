"""Reading recordings of the graph."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection
from rosbags.typesys import Stores, get_typestore

from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, RIGID_STATES, THETA, THETA_DOT
from furuta_ros.messages import NANOSECONDS
from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, GROUND_TRUTH

# Messages of one topic that are read into memory at most: a quarter of an hour at 1 kHz.
LONGEST = 1_000_000


class Bag:
    """A bag of any origin, to be read in a ``with``; says in one line what is wrong with it.

    ``connections`` are its topics with types and counts, ``start`` its first time [ns].
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        if not path.exists():
            raise ParameterError(f"no bag {path}")
        with self._reading():
            self._reader = AnyReader([path], default_typestore=get_typestore(Stores.ROS2_JAZZY))

    def __enter__(self) -> Bag:
        with self._reading():
            self._reader.open()
            self.connections: list[Connection] = self._reader.connections
            self.message_count: int = self._reader.message_count
            self.start: int = self._reader.start_time
            self.seconds = max(0, self._reader.duration - 1) / NANOSECONDS
        return self

    def __exit__(self, *_: object) -> None:
        self._reader.close()

    def messages(
        self, connections: Iterable[Connection] | None = None
    ) -> Iterator[tuple[Connection, int, bytes]]:
        """Messages of ``connections``, by default of all, with their times [ns]."""
        chosen = self.connections if connections is None else list(connections)
        if chosen:
            with self._reading():
                yield from self._reader.messages(chosen)

    def deserialize(self, data: bytes, kind: str) -> Any:
        """A message from its content."""
        with self._reading():
            return self._reader.deserialize(data, kind)

    @contextmanager
    def _reading(self) -> Iterator[None]:
        """Whatever is raised by reading a bag that is none, or not a whole one."""
        try:
            yield
        except Exception as error:
            reason = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise ParameterError(
                f"{self._path} is no readable bag: {reason} "
                "(`furuta bag recover` mends what it can)"
            ) from None


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
    with Bag(path) as reader:
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
