"""Reads bags of any origin."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from rosbags.rosbag2 import Reader
from rosbags.typesys.store import Typestore

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.bag_files import bag_files, whole_files
from furuta_recordings.bags.message_types import definition_of, typestore_of
from furuta_ros.time_stamps import NANOSECONDS

# Most messages of one topic that are read into memory: a quarter of an hour at 1 kHz.
MOST_IN_MEMORY = 1_000_000
# Latest time of a message [ns]; an MCAP file can hold twice as much.
LATEST = 2**63 - 1


class Topic(NamedTuple):
    """A topic of a bag with its message type and the number of its messages."""

    topic: str
    msgtype: str
    msgcount: int


class Bag:
    """A bag of any origin, opened by ``with``; every problem with it is a one-line error.

    ``connections`` are its topics with types and counts, ``start`` its first time [ns], ``seconds``
    its duration [s]. Nothing outside the bag is read, and no more memory used than
    :mod:`furuta_recordings.bags.limits` allows.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._readers: list[Reader] = []
        self._definitions: dict[str, str] = {}
        self._types: dict[str, Typestore] = {}
        if not path.exists():
            raise ParameterError(f"no bag {path}")

    def __enter__(self) -> Bag:
        with self._one_line_errors(), ExitStack() as opened:
            content = bag_files(self._path)
            files = opened.enter_context(whole_files(content.files))
            self._readers = [opened.enter_context(Reader(file)) for file in files]
            self._describe(content.topics)
            self._opened = opened.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._opened.close()

    def _describe(self, named: Iterable[tuple[str, str]]) -> None:
        """Topics and times, from the files; the metadata adds topics without a message."""
        counts = dict.fromkeys(named, 0)
        for reader in self._readers:
            for topic in reader.connections:
                key = (topic.topic, topic.msgtype)
                counts[key] = counts.get(key, 0) + topic.msgcount
                self._definitions.setdefault(topic.msgtype, topic.msgdef.data)
        self.connections = [Topic(*key, count) for key, count in counts.items()]
        used = [reader for reader in self._readers if reader.message_count]
        self.message_count: int = sum(reader.message_count for reader in used)
        self.start: int = min((reader.start_time for reader in used), default=0)
        end = max((reader.end_time for reader in used), default=0)
        self.seconds = max(0, end - self.start - 1) / NANOSECONDS

    def messages(
        self,
        connections: Iterable[Topic] | None = None,
        first: int | None = None,
        last: int | None = None,
    ) -> Iterator[tuple[Topic, int, bytes]]:
        """Messages of ``connections``, by default of all, with their times [ns].

        Only messages with ``first`` <= time < ``last`` [ns]: only their part of an indexed file is
        read.
        """
        topics = self.connections if connections is None else connections
        chosen = {(topic.topic, topic.msgtype): topic for topic in topics}
        with self._one_line_errors():
            for reader in self._readers:
                own = [c for c in reader.connections if (c.topic, c.msgtype) in chosen]
                for c, time, data in reader.messages(own, first, last) if own else ():
                    if time > LATEST:
                        raise ParameterError(f"a message on {c.topic} has the time {time} ns")
                    yield chosen[c.topic, c.msgtype], time, data

    def find(self, topic: Topic, first: int, last: int) -> tuple[np.ndarray, list[bytes]]:
        """Times (n,) [ns] and contents of a topic's messages with ``first`` <= time < ``last``."""
        messages = [(time, data) for _, time, data in self.messages([topic], first, last)]
        messages.sort(key=lambda message: message[0])
        return np.array([time for time, _ in messages], np.int64), [data for _, data in messages]

    def messages_in_memory(self, chosen: Iterable[Topic]) -> Iterator[tuple[Topic, int, bytes]]:
        """Messages as :meth:`messages` gives them; refuses topics that do not fit into memory.

        Both the number that a file claims and the number that it has count.
        """
        read: Counter[str] = Counter()
        for topic, time, data in self.messages(chosen):
            read[topic.topic] += 1
            count = max(topic.msgcount, read[topic.topic])
            if count > MOST_IN_MEMORY:
                raise ParameterError(
                    f"{self._path}: {count} messages on {topic.topic}, at most {MOST_IN_MEMORY} "
                    "fit into memory; record shorter bags"
                )
            yield topic, time, data

    def deserialize(self, data: bytes, type_name: str) -> Any:
        """A message from its serialized content."""
        with self._one_line_errors():
            if type_name not in self._types:
                definition = self._definitions.get(type_name) or definition_of(type_name)
                self._types[type_name] = typestore_of(type_name, definition)
            return self._types[type_name].deserialize_cdr(data, type_name)

    @contextmanager
    def _one_line_errors(self) -> Iterator[None]:
        """Turn whatever a reader raises on a damaged bag into one :class:`ParameterError`."""
        try:
            yield
        except Exception as error:
            reason = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise ParameterError(
                f"{self._path} is not a readable bag: {reason} "
                "(`furuta bag recover` copies what is still readable into a new bag)"
            ) from None


def last_part(topic: str) -> str:
    """The topic's name without its namespace."""
    return topic.rpartition("/")[2]
