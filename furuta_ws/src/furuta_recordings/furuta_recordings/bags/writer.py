"""Writes a rosbag2 directory with one MCAP file.

The file consists of chunks with the messages of a tenth of a second or less. A chunk that was
written survives the end of this process, however it ends.
"""

import os
import shutil
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path
from time import monotonic
from typing import IO, cast

from mcap.writer import CompressionType, Writer

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.metadata import METADATA_FILE, BagTopic, as_yaml, metadata
from furuta_ros.errors import UserError
from furuta_ros.whole_files import make_directory, whole_file

# Largest chunk [bytes], and longest time [s] until it is written.
LARGEST_CHUNK = 2**16
FLUSH_INTERVAL = 0.1
# Most bytes that may wait for the disk; if more must, it is too slow.
LARGEST_BACKLOG = 2**26


def check_new_bag(path: Path) -> None:
    """Raise :class:`ParameterError` if no bag ``path`` can be made; so before anything runs."""
    _make(path)
    path.rmdir()


def _make(path: Path) -> None:
    if os.path.lexists(path):
        raise ParameterError(f"{path} already exists; name another directory for the bag")
    try:
        make_directory(path.parent)
        path.mkdir()
    except OSError as error:
        reason = f"{error.filename}: {error.strerror}"
        raise ParameterError(f"cannot make the bag {path}: {reason}") from None


class BagWriter:
    """Writes messages into the bag ``path``, which must not exist yet.

    ``parameters`` (file name: text) are stored beside the data. When too much waits for the disk
    :meth:`flush` ``waits``, or raises an error.

    Raises:
        UserError: The disk does not take the data.
        ParameterError: There is such a bag already, or its directory cannot be made.
    """

    def __init__(
        self,
        path: Path,
        topics: Iterable[BagTopic],
        parameters: Mapping[str, str],
        waits: bool = True,
    ) -> None:
        self.path = path
        self.closed = False
        self._topics: list[BagTopic] = []
        self._schemas: dict[str, int] = {}  # by message type
        self._counts: list[int] = []
        self._times = 2**63 - 1, 0
        self._next_flush = 0.0
        _make(path)
        try:
            with self._disk_errors():
                for name, text in parameters.items():
                    (path / name).write_text(text, encoding="utf-8")
                self._file = BackgroundFile(path / f"{path.name}_0.mcap", waits)
            stream = cast("IO[bytes]", self._file)
            self._writer = Writer(stream, LARGEST_CHUNK, CompressionType.NONE)
            self._writer.start("ros2")
            for topic in topics:
                self.add_topic(topic)
            self._describe()
        except BaseException:
            shutil.rmtree(path, ignore_errors=True)
            raise

    def add_topic(self, topic: BagTopic) -> int:
        """Add a topic, unless it is there; returns its index."""
        if topic in self._topics:
            return self._topics.index(topic)
        name, definition = topic.type_name, topic.definition.encode()
        if name not in self._schemas:
            self._schemas[name] = self._writer.register_schema(name, topic.encoding, definition)
        about = {"offered_qos_profiles": topic.qos, "topic_type_hash": topic.type_hash}
        self._writer.register_channel(topic.name, "cdr", self._schemas[name], about)
        self._topics.append(topic)
        self._counts.append(0)
        return len(self._topics) - 1

    def add(self, topic: int, time: int, data: bytes) -> None:
        """Take a message of one of the topics (index), received at ``time`` [ns]."""
        self._writer.add_message(topic + 1, time, data, time)  # numbers of channels begin at 1
        self._counts[topic] += 1
        first, last = self._times
        self._times = min(first, time), max(last, time)

    def flush(self) -> None:
        """Begin to write what was added, if the last time is long enough ago."""
        if monotonic() >= self._next_flush:
            with self._disk_errors():
                self._writer.flush()
            self._next_flush = monotonic() + FLUSH_INTERVAL

    def close(self) -> None:
        """Write what is left and finish the bag; may be called twice."""
        if self.closed:
            return
        self.closed = True
        try:
            with self._disk_errors():
                self._writer.finish()
                self._file.finish()
            self._describe()
        finally:
            self._file.close()

    @contextmanager
    def _disk_errors(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise UserError(f"{self.path}: {error.strerror or error}") from None

    def _describe(self) -> None:
        """Write the metadata beside the data."""
        times = self._times if any(self._counts) else (0, 0)
        about = metadata(self._topics, self._counts, f"{self.path.name}_0.mcap", times)
        with whole_file(self.path / METADATA_FILE) as new:
            new.write_text(as_yaml(about), encoding="utf-8")


class BackgroundFile:
    """A new file that a thread writes, so that a slow disk makes nobody wait.

    Writing releases Python's lock. An error of the thread is raised by the next call.
    """

    def __init__(self, path: Path, waits: bool) -> None:
        self._file = path.open("xb")
        self._waits = waits
        self._place = 0
        self._pending = bytearray()
        self._thread = ThreadPoolExecutor(1, initializer=_use_ordinary_scheduling)
        self._writing: Future[None] = self._thread.submit(self._file.flush)

    def write(self, data: bytes) -> None:
        """Take data, which wait for :meth:`flush`."""
        self._pending += data
        self._place += len(data)

    def tell(self) -> int:
        """The number of bytes that were taken."""
        return self._place

    def flush(self) -> None:
        """Begin to write what waits, unless the thread is still writing."""
        too_large = len(self._pending) > LARGEST_BACKLOG
        if not self._writing.done() and not (too_large and self._waits):
            if too_large:
                raise OSError("the disk is too slow for this recording")
            return
        self._writing.result()
        data, self._pending = self._pending, bytearray()
        self._writing = self._thread.submit(self._write, data)

    def _write(self, data: bytearray) -> None:
        self._file.write(data)
        self._file.flush()

    def finish(self) -> None:
        """Write everything."""
        self._writing.result()
        self._write(self._pending)

    def close(self) -> None:
        """Close the file, complete or not."""
        self._thread.shutdown()
        with suppress(OSError):  # that the user already knows
            self._file.close()


def _use_ordinary_scheduling() -> None:
    """Do not inherit the real-time priority of the control loop, and never preempt it."""
    with suppress(OSError, AttributeError):  # only Linux has it
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
