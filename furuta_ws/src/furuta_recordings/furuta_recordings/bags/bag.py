"""Reads bags of any origin."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from math import nan
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
from rosbags.rosbag2 import Reader
from rosbags.typesys.store import Typestore

from furuta_model.parameters import ParameterError
from furuta_model.state import EFFORT, PHI, PHI_DOT, SIGNALS, THETA, THETA_DOT
from furuta_recordings.bags.bag_files import BagFiles, bag_files
from furuta_recordings.bags.decompression import decompress_file, decompress_message
from furuta_recordings.bags.message_types import definition_of, typestore_of
from furuta_recordings.bags.sqlite_files import check_sqlite, copy_whole, has_log
from furuta_ros.time_stamps import NANOSECONDS

# Most messages of one topic that are read into memory: a quarter of an hour at 1 kHz.
MOST_IN_MEMORY = 1_000_000


class Topic(NamedTuple):
    """A topic of a bag with its message type and the number of its messages."""

    topic: str
    msgtype: str
    msgcount: int


class Messages(NamedTuple):
    """Messages of one topic: ``times`` (n,) [ns] in order, and their serialized content."""

    times: np.ndarray
    data: list[bytes]


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
            self._compression = content.compression
            files = opened.enter_context(checked_files(content))
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
        between: tuple[int | None, int | None] = (None, None),
    ) -> Iterator[tuple[Topic, int, bytes]]:
        """Messages of ``connections``, by default of all, with their times [ns].

        ``between`` is the first time [ns] and the one after the last; only their part of an indexed
        file is read.
        """
        chosen = {
            (topic.topic, topic.msgtype): topic
            for topic in (self.connections if connections is None else connections)
        }
        with self._one_line_errors():
            for reader in self._readers:
                yield from self._messages_of(reader, chosen, *between)

    def _messages_of(
        self,
        reader: Reader,
        chosen: dict[tuple[str, str], Topic],
        first: int | None,
        last: int | None,
    ) -> Iterator[tuple[Topic, int, bytes]]:
        """The messages of one file."""
        own = [c for c in reader.connections if (c.topic, c.msgtype) in chosen]
        for c, time, data in reader.messages(own, first, last) if own else ():
            yield chosen[c.topic, c.msgtype], time, self._plain(data)

    def find(self, topic: Topic, first: int, last: int) -> Messages:
        """Messages of a topic with ``first`` <= time < ``last`` [ns]."""
        messages = [(time, data) for _, time, data in self.messages([topic], (first, last))]
        messages.sort(key=lambda message: message[0])
        times = np.array([time for time, _ in messages], np.int64)
        return Messages(times, [data for _, data in messages])

    def messages_in_memory(self, connections: Iterable[Topic]) -> Iterator[tuple[Topic, int, Any]]:
        """Messages, deserialized; refuses topics that do not fit into memory.

        The number that a file claims is checked before, and the number that it has on the way.
        """
        chosen = list(connections)
        refuse_too_long(self._path, chosen)
        read: Counter[str] = Counter()
        for connection, time, data in self.messages(chosen):
            read[connection.topic] += 1
            if read[connection.topic] > MOST_IN_MEMORY:
                refuse_too_long(self._path, [connection._replace(msgcount=MOST_IN_MEMORY + 1)])
            yield connection, time, self.deserialize(data, connection.msgtype)

    def deserialize(self, data: bytes, type_name: str) -> Any:
        """A message from its serialized content."""
        with self._one_line_errors():
            if type_name not in self._types:
                definition = self._definitions.get(type_name) or definition_of(type_name)
                self._types[type_name] = typestore_of(type_name, definition)
            return self._types[type_name].deserialize_cdr(data, type_name)

    def _plain(self, data: bytes) -> bytes:
        return decompress_message(data) if self._compression == "message" else data

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


@contextmanager
def checked_files(bag: BagFiles) -> Iterator[list[Path]]:
    """The data files of a bag, decompressed where they are compressed as a whole.

    Raises:
        DamagedError: A file claims more than it may hold.
    """
    with TemporaryDirectory(prefix="furuta-bag-") as directory:
        files = list(bag.files)
        if bag.compression == "file":
            files = [Path(directory) / file.stem for file in bag.files]
            for file, plain in zip(bag.files, files, strict=True):
                decompress_file(file, plain)
        for number, file in enumerate(files):
            if file.suffix == ".db3":
                check_sqlite(file)
                if has_log(file):
                    files[number] = Path(directory) / file.name
                    copy_whole(file, files[number])
        yield files


def refuse_too_long(path: Path, connections: Iterable[Topic]) -> None:
    """Refuse topics that do not fit into memory, before any message is read."""
    for topic in connections:
        if topic.msgcount > MOST_IN_MEMORY:
            raise ParameterError(
                f"{path}: {topic.msgcount} messages on {topic.topic}, at most {MOST_IN_MEMORY} fit "
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
