"""Writes a rosbag2 directory with one sqlite3 file.

The file is in write-ahead mode: what a flush has committed survives the end of this process,
however it ends, and sqlite3 restores a consistent file when it is opened next.
"""

import os
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.metadata import (
    DISTRIBUTION,
    VERSION,
    BagFile,
    BagTopic,
    information,
    write_metadata,
)

# The tables of rosbag2's sqlite3 storage in Jazzy.
_SCHEMA_VERSION = 4
_SCHEMA = """
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
# Most bytes that wait for a flush.
LARGEST_PENDING = 2**20


class BagWriter:
    """Writes messages into the bag ``path``, which must not exist yet.

    The bag is created under a temporary name and renamed when it is complete. ``parameters`` (file
    name: text) are stored beside the data.

    Raises:
        OSError: The disk does not take the data.
    """

    def __init__(self, path: Path, topics: list[BagTopic], parameters: dict[str, str]) -> None:
        if path.exists():
            raise ParameterError(f"{path} already exists; name another directory for the bag")
        path.parent.mkdir(parents=True, exist_ok=True)
        self.path, self._topics = path, topics
        self._name = f"{path.name}_0.db3"
        self._counts = [0] * len(topics)
        self._start, self._end = 2**63 - 1, 0
        self._rows: list[tuple[int, int, bytes]] = []
        self.pending_bytes = 0
        new = path.with_name(f".{path.name}.new")
        shutil.rmtree(new, ignore_errors=True)
        new.mkdir()
        for name, text in parameters.items():
            (new / name).write_text(text)
        create_file(new / self._name, topics)
        self._update_metadata(new)
        new.rename(path)
        self._database = sqlite3.connect(path / self._name)
        self._database.execute("PRAGMA synchronous = OFF")
        # Each flush also reaches the file itself, for readers that ignore the write-ahead log.
        self._database.execute("PRAGMA wal_autocheckpoint = 1")

    def add(self, topic: int, time: int, data: bytes) -> None:
        """Take a message of one of the topics (index), received at ``time`` [ns]."""
        self._rows.append((topic + 1, time, data))
        self._counts[topic] += 1
        self._start, self._end = min(self._start, time), max(self._end, time)
        self.pending_bytes += len(data)
        if self.pending_bytes > LARGEST_PENDING:
            self.flush()

    def flush(self) -> None:
        """Write all messages taken so far, so that they survive the end of this process."""
        try:
            with self._database:
                self._database.executemany(
                    "INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)", self._rows
                )
        except sqlite3.Error as error:
            raise OSError(0, str(error), str(self.path)) from None
        self._rows.clear()
        self.pending_bytes = 0
        self._update_metadata(self.path)

    def close(self) -> None:
        """Finish the bag: one file, without a journal beside it."""
        try:
            self.flush()
            self._database.execute("PRAGMA journal_mode = DELETE")
        finally:
            self._database.close()

    def _update_metadata(self, directory: Path) -> None:
        file = BagFile(self._name, sum(self._counts), self._start, self._end)
        write_metadata(directory, self._topics, self._counts, [file])


def create_file(file: Path, topics: list[BagTopic]) -> None:
    """Make a bag file without messages."""
    distribution = os.environ.get("ROS_DISTRO") or DISTRIBUTION
    described = information(topics, [0] * len(topics), [])
    definitions = {topic.type_name: topic for topic in reversed(topics)}
    with closing(sqlite3.connect(file)) as database, database:
        database.execute("PRAGMA journal_mode = WAL")
        database.executescript(_SCHEMA)
        database.execute("INSERT INTO schema VALUES (?, ?)", (_SCHEMA_VERSION, distribution))
        database.execute("INSERT INTO metadata VALUES (1, ?, ?)", (VERSION, described))
        database.executemany(
            "INSERT INTO topics VALUES (?, ?, ?, 'cdr', ?, ?)",
            (
                (number, topic.name, topic.type_name, topic.qos, topic.type_hash)
                for number, topic in enumerate(topics, 1)
            ),
        )
        database.executemany(
            "INSERT INTO message_definitions"
            "(topic_type, encoding, encoded_message_definition, type_description_hash) "
            "VALUES (?, 'ros2msg', ?, ?)",
            (
                (topic.type_name, topic.definition, topic.type_hash)
                for topic in definitions.values()
            ),
        )
