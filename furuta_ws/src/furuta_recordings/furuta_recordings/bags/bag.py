"""Reads bags of any origin, MCAP or sqlite3."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rosbags.interfaces import Connection
from rosbags.rosbag2 import Reader
from rosbags.typesys.store import Typestore

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.bag_files import SUFFIXES, advice, bag_files, refuse_foreign
from furuta_recordings.bags.mcap_records import foreign_messages
from furuta_recordings.bags.message_types import JAZZY, definition_of, typestore_of
from furuta_recordings.bags.metadata import METADATA_FILE, PARAMETERS_FILE
from furuta_ros.time_stamps import NANOSECONDS


class Bag:
    """A bag of any origin, opened by ``with``; every problem with it is a one-line error.

    ``connections`` are its topics with types and counts, ``start`` its first time [ns], ``seconds``
    its duration [s].
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._types: dict[str, Typestore] = {}
        if not path.exists():
            raise ParameterError(f"no bag {path}")

    def __enter__(self) -> Bag:
        refuse_foreign(self.path)
        self._refuse_open_log()
        with self._one_line_errors():
            self._reader = Reader(self._described())
            self._reader.open()
        self.connections: list[Connection] = list(self._reader.connections)
        self.message_count: int = self._reader.message_count
        self.start: int = self._reader.start_time if self.message_count else 0
        self.seconds = max(0, self._reader.duration - 1) / NANOSECONDS
        return self

    def __exit__(self, *_: object) -> None:
        self._reader.close()

    def _described(self) -> Path:
        """What describes the messages: metadata, or the only file of a directory without."""
        if not self.path.is_dir() or (self.path / METADATA_FILE).is_file():
            return self.path
        files = bag_files(self.path)
        if not files:
            raise ParameterError(
                f"it has neither {METADATA_FILE} nor a file {' or '.join(SUFFIXES)}"
            )
        if len(files) > 1:
            raise ParameterError(f"it has no {METADATA_FILE}")
        return files[0]

    def _refuse_open_log(self) -> None:
        """Refuse a sqlite3 file with a write-ahead log, which the reader ignores."""
        beside = self.path.parent / f"{self.path.name}-wal"
        for log in (beside, *self.path.glob("*.db3-wal")):
            if log.is_file() and log.stat().st_size:
                file = str(log).removesuffix("-wal")
                raise ParameterError(
                    f"{log} holds messages; `sqlite3 {file} 'PRAGMA journal_mode=DELETE'` moves "
                    "them into the bag"
                )

    def messages(
        self, connections: Iterable[Connection] | None = None
    ) -> Iterator[tuple[Connection, int, bytes]]:
        """Messages of ``connections``, by default of all, with their times [ns], in their order."""
        chosen = self.connections if connections is None else list(connections)
        with self._one_line_errors():
            if chosen:  # the reader takes none for all
                yield from self._reader.messages(chosen)

    def deserialize(self, data: bytes, type_name: str) -> Any:
        """A message from its serialized content."""
        definition = "" if type_name in self._types else self._definition_of(type_name)
        with self._one_line_errors():
            if type_name not in self._types:
                self._types[type_name] = typestore_of(type_name, definition)
            return self._types[type_name].deserialize_cdr(data, type_name)

    def _definition_of(self, type_name: str) -> str:
        """The type as the bag defines it, or else ROS."""
        own = (each.msgdef.data for each in self.connections if each.msgtype == type_name)
        definition = next(own, "")
        if not definition and type_name not in JAZZY.types:
            raise ParameterError(
                f"{self.path} does not define the type {type_name}; `ros2 bag convert` adds the "
                "definition where its package is installed"
            )
        return definition or definition_of(type_name)

    @contextmanager
    def _one_line_errors(self) -> Iterator[None]:
        """Turn whatever a reader raises on a damaged bag into one :class:`ParameterError`."""
        try:
            yield
        except Exception as error:
            reason = str(error).splitlines()[0] if str(error) else type(error).__name__
            about = foreign_messages(self.path) or f"{reason}{advice(self.path)}"
            raise ParameterError(f"{self.path} is not a readable bag: {about}") from None


def parameter_file_of(bag: Path) -> Path | None:
    """The parameter file beside the data, if there is one."""
    file = bag / PARAMETERS_FILE
    return file if file.is_file() else None


def last_part(topic: str) -> str:
    """The topic's name without its namespace."""
    return topic.rpartition("/")[2]
