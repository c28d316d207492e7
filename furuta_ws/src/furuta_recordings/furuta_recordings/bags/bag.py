"""Reads bags of any origin."""

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
from furuta_model.time_stamps import NANOSECONDS

# Most messages of one topic that are read into memory: a quarter of an hour at 1 kHz.
MOST_IN_MEMORY = 1_000_000


class Bag:
    """A bag of any origin, opened by ``with``; every problem with it is a one-line error.

    ``connections`` are its topics with types and counts, ``start`` its first time [ns], ``seconds``
    its duration [s].
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        if not path.exists():
            raise ParameterError(f"no bag {path}")
        with self._one_line_errors():
            self._reader = AnyReader([path], default_typestore=get_typestore(Stores.ROS2_JAZZY))

    def __enter__(self) -> Bag:
        with self._one_line_errors():
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
            with self._one_line_errors():
                yield from self._reader.messages(chosen)

    def deserialize(self, data: bytes, type_name: str) -> Any:
        """A message from its serialized content."""
        with self._one_line_errors():
            return self._reader.deserialize(data, type_name)

    @contextmanager
    def _one_line_errors(self) -> Iterator[None]:
        """Turn whatever the reader raises on a damaged bag into one :class:`ParameterError`."""
        try:
            yield
        except Exception as error:
            reason = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise ParameterError(
                f"{self._path} is not a readable bag: {reason} "
                "(`furuta bag recover` copies what is still readable into a new bag)"
            ) from None


def refuse_too_long(path: Path, connections: Iterable[Connection]) -> None:
    """Refuse topics that do not fit into memory, before any message is read."""
    for each in connections:
        if each.msgcount > MOST_IN_MEMORY:
            raise ParameterError(
                f"{path}: {each.msgcount} messages on {each.topic}, at most {MOST_IN_MEMORY} fit "
                "into memory; record shorter bags"
            )


def signals(message: Any) -> list[float]:
    """Angles, speeds and the arm's effort in the graph's joint states; NaN without an effort."""
    x = [0.0] * SIGNALS
    x[PHI], x[THETA] = message.position
    x[PHI_DOT], x[THETA_DOT] = message.velocity
    x[EFFORT] = message.effort[0] if len(message.effort) else nan
    return x


def last_part(topic: str) -> str:
    """The topic's name without its namespace."""
    return topic.rpartition("/")[2]
