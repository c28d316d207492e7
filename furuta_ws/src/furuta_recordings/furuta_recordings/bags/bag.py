"""Reading bags of any origin."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from math import nan
from pathlib import Path
from typing import Any

from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection
from rosbags.typesys import Stores, get_typestore

from furuta_model.parameters import ParameterError
from furuta_model.state import EFFORT, PHI, PHI_DOT, SIGNALS, THETA, THETA_DOT
from furuta_ros.messages import NANOSECONDS

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


def signals(message: Any) -> list[float]:
    """Angles, speeds and the arm's effort in joint states of the graph, NaN if there is none."""
    x = [0.0] * SIGNALS
    x[PHI], x[THETA] = message.position
    x[PHI_DOT], x[THETA_DOT] = message.velocity
    x[EFFORT] = message.effort[0] if len(message.effort) else nan
    return x


def last_part(topic: str) -> str:
    """The topic's name without its namespace."""
    return topic.rpartition("/")[2]
