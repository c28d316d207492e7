"""Writes a rosbag2 directory with one sqlite3 file.

The file is in write-ahead mode: what a flush has committed survives the end of this process,
however it ends, and sqlite3 restores a consistent file when it is opened next.
"""

import os
import shutil
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing, contextmanager
from itertools import chain
from pathlib import Path

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.metadata import (
    METADATA_FILE,
    SECTION,
    VERSION,
    BagTopic,
    as_yaml,
    distribution,
    metadata,
)
from furuta_ros.whole_files import make_directory

# The tables of rosbag2's sqlite3 storage in Jazzy.
_SCHEMA_VERSION = 4
_SCHEMA = """
PRAGMA journal_mode = WAL;
CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
CREATE TABLE metadata(
    id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
CREATE TABLE topics(
    id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
    serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL,
    type_description_hash TEXT NOT NULL);
CREATE TABLE message_definitions(
    id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
    encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
CREATE TABLE messages(
    id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
    data BLOB NOT NULL);
CREATE INDEX timestamp_idx ON messages(timestamp ASC);
"""
# Messages that one statement writes. Python's lock is taken between two statements.
TOGETHER = 100
# Most bytes that wait for a flush.
LARGEST_PENDING = 2**20

# Topic (index), time of arrival [ns], content.
Row = tuple[int, int, bytes]


def check_new_bag(path: Path) -> None:
    """Raise :class:`ParameterError` if no bag ``path`` can be made; so before anything runs."""
    _make_new(path).rmdir()


def _make_new(path: Path) -> Path:
    """The directory, made under a temporary name, that becomes the bag ``path``."""
    if os.path.lexists(path):
        raise ParameterError(f"{path} already exists; name another directory for the bag")
    new = path.with_name(f".{path.name}.new")
    try:
        make_directory(path.parent)
        shutil.rmtree(new, ignore_errors=True)
        new.mkdir()
    except OSError as error:
        reason = f"{error.filename}: {error.strerror}"
        raise ParameterError(f"cannot make the bag {path}: {reason}") from None
    return new


class BagWriter:
    """Writes messages into the bag ``path``, which must not exist yet.

    The bag is created under a temporary name and renamed when it is complete. ``parameters`` (file
    name: text) are stored beside the data. One thread at a time may use it.

    Raises:
        OSError: The disk does not take the data.
        ParameterError: There is such a bag already, or its directory cannot be made.
    """

    def __init__(
        self, path: Path, topics: Iterable[BagTopic], parameters: Mapping[str, str]
    ) -> None:
        new = _make_new(path)
        self.path, self._file = path, f"{path.name}_0.db3"
        self._topics: list[BagTopic] = []
        self._defined: set[str] = set()  # names of message types
        self._counts: list[int] = []
        self._start, self._end = 2**63 - 1, 0
        self._rows: list[Row] = []
        self._pending_bytes = 0
        try:
            for name, text in parameters.items():
                (new / name).write_text(text)
            self._database = sqlite3.connect(new / self._file)
            with self._disk_errors(), closing(self._database):
                self._database.executescript(_SCHEMA)
                self._database.execute(
                    "INSERT INTO schema VALUES (?, ?)", (_SCHEMA_VERSION, distribution())
                )
                for topic in topics:
                    self.add_topic(topic)
                self._describe(new)
            new.rename(path)
        except BaseException:
            shutil.rmtree(new, ignore_errors=True)
            raise
        self._database = sqlite3.connect(path / self._file, check_same_thread=False)
        self._database.execute("PRAGMA synchronous = OFF")
        # Each flush also reaches the file itself, for readers that ignore the write-ahead log.
        self._database.execute("PRAGMA wal_autocheckpoint = 1")

    def add_topic(self, topic: BagTopic) -> int:
        """Add a topic; returns its index."""
        if topic.type_name not in self._defined:
            self._defined.add(topic.type_name)
            self._database.execute(
                "INSERT INTO message_definitions"
                "(topic_type, encoding, encoded_message_definition, type_description_hash) "
                "VALUES (?, 'ros2msg', ?, ?)",
                (topic.type_name, topic.definition, topic.type_hash),
            )
        self._topics.append(topic)
        self._counts.append(0)
        self._database.execute(
            "INSERT INTO topics VALUES (?, ?, ?, 'cdr', ?, ?)",
            (len(self._topics), topic.name, topic.type_name, topic.qos, topic.type_hash),
        )
        return len(self._topics) - 1

    def add(self, topic: int, time: int, data: bytes) -> None:
        """Take a message of one of the topics (index), received at ``time`` [ns]."""
        self._rows.append((topic, time, data))
        self._pending_bytes += len(data)
        if self._pending_bytes > LARGEST_PENDING:
            self.flush()

    def flush(self) -> None:
        """Write all messages taken so far."""
        rows, self._rows, self._pending_bytes = self._rows, [], 0
        self.write(rows)

    def write(self, rows: list[Row]) -> None:
        """Write messages, so that they survive the end of this process."""
        with self._disk_errors(), self._database:
            for first in range(0, len(rows), TOGETHER):
                group = rows[first : first + TOGETHER]
                self._database.execute(
                    "INSERT INTO messages(topic_id, timestamp, data) VALUES "
                    + ",".join(["(? + 1, ?, ?)"] * len(group)),
                    list(chain.from_iterable(group)),
                )
        for topic, time, _ in rows:
            self._counts[topic] += 1
            self._start, self._end = min(self._start, time), max(self._end, time)

    def close(self) -> None:
        """Finish the bag: one file, without a journal beside it."""
        with self._disk_errors(), closing(self._database):
            self.flush()
            self._describe(self.path)
            self._database.execute("PRAGMA journal_mode = DELETE")

    @contextmanager
    def _disk_errors(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            raise OSError(0, str(error), str(self.path)) from None

    def _describe(self, directory: Path) -> None:
        """Write the metadata, beside the data and into the file."""
        times = (self._start, self._end) if any(self._counts) else (0, 0)
        about = metadata(self._topics, self._counts, self._file, times)
        new = directory / f"{METADATA_FILE}.new"
        try:
            new.write_text(as_yaml({SECTION: about}))
            new.rename(directory / METADATA_FILE)
        finally:
            new.unlink(missing_ok=True)
        with self._database:
            self._database.execute(
                "INSERT OR REPLACE INTO metadata VALUES (1, ?, ?)", (VERSION, as_yaml(about))
            )
