"""Reads bags of any origin."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
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
from furuta_recordings.bags.mcap_bounds import check_mcap
from furuta_recordings.bags.mcap_index import McapIndex
from furuta_recordings.bags.message_types import definition_of, typestore_of
from furuta_recordings.bags.sqlite_bounds import check_sqlite
from furuta_ros.time_stamps import NANOSECONDS

# Most messages of one topic that are read into memory: a quarter of an hour at 1 kHz.
MOST_IN_MEMORY = 1_000_000


class Topic(NamedTuple):
    """A topic of a bag with its message type and the number of its messages."""

    topic: str
    msgtype: str
    msgcount: int


# Times (n,) [ns] of messages, and a function that reads one of them.
_Part = tuple[np.ndarray, Callable[[int], bytes]]


class Messages:
    """Messages of one topic in the order of their ``times`` (n,) [ns]."""

    def __init__(self, parts: Sequence[_Part]) -> None:
        times = np.concatenate([np.zeros(0, np.int64), *(each for each, _ in parts)])
        order = np.argsort(times, kind="stable")
        self.times: np.ndarray = times[order]
        places = [(read, number) for each, read in parts for number in range(len(each))]
        self._places = [places[number] for number in order]

    def __getitem__(self, number: int) -> bytes:
        """The serialized content of a message."""
        read, own = self._places[number]
        return read(own)


class Bag:
    """A bag of any origin, opened by ``with``; every problem with it is a one-line error.

    ``connections`` are its topics with types and counts, ``start`` its first time [ns], ``seconds``
    its duration [s]. Nothing outside the bag is read, and no more memory used than
    :mod:`furuta_recordings.bags.bounds` allows.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._readers: list[Reader] = []
        self._definitions: dict[str, str] = {}
        self._types: dict[str, Typestore] = {}
        self._indexes: dict[int, McapIndex | None] = {}
        if not path.exists():
            raise ParameterError(f"no bag {path}")

    def __enter__(self) -> Bag:
        with self._one_line_errors(), ExitStack() as opened:
            found = bag_files(self._path)
            self._compression = found.compression
            self._files = opened.enter_context(checked_files(found))
            self._readers = [opened.enter_context(Reader(file)) for file in self._files]
            self._describe(found.topics)
            self._opened = opened.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._opened.close()

    def _describe(self, named: Iterable[tuple[str, str]]) -> None:
        """Topics and times, from the files; the metadata adds topics without a message."""
        counts = dict.fromkeys(named, 0)
        for reader in self._readers:
            for each in reader.connections:
                key = (each.topic, each.msgtype)
                counts[key] = counts.get(key, 0) + each.msgcount
                self._definitions.setdefault(each.msgtype, each.msgdef.data)
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
            (each.topic, each.msgtype): each
            for each in (self.connections if connections is None else connections)
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
        """Messages of a topic with ``first`` <= time < ``last`` [ns].

        Of an indexed file only those are read that are taken from the result, while the bag is
        open. Of another file all are read at once.
        """
        with self._one_line_errors():
            return Messages(
                [
                    self._part(number, topic, first, last)
                    for number, reader in enumerate(self._readers)
                    if reader.start_time < last and reader.end_time > first
                ]
            )

    def _part(self, file: int, topic: Topic, first: int, last: int) -> _Part:
        """The messages of one file."""
        index = self._index(file)
        if index is None:
            found = list(self._messages_of(self._readers[file], {topic[:2]: topic}, first, last))
            times = np.array([time for _, time, _ in found], np.int64)
            return times, lambda number: found[number][2]
        places = index.find(topic.topic, topic.msgtype, first, last)

        def read(number: int) -> bytes:
            with self._one_line_errors():
                _, chunk, offset = places[number].item()
                return self._plain(index.read(chunk, offset))

        return places["time"], read

    def _index(self, file: int) -> McapIndex | None:
        """The index of a file, if it has one."""
        if file not in self._indexes:
            path, found = self._files[file], None
            if path.suffix == ".mcap":
                found = self._opened.enter_context(closing(McapIndex(path)))
            self._indexes[file] = found if found and found.is_complete else None
        return self._indexes[file]

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
        files = bag.files
        if bag.compression == "file":
            files = [Path(directory) / file.stem for file in bag.files]
            for file, plain in zip(bag.files, files, strict=True):
                decompress_file(file, plain)
        for file in files:
            if file.suffix == ".db3":
                check_sqlite(file)
            else:
                check_mcap(file)
        yield files


def refuse_too_long(path: Path, connections: Iterable[Topic]) -> None:
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
