"""Writes a rosbag2 directory whose MCAP files are complete at every moment."""

from __future__ import annotations

import shutil
from pathlib import Path

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.mcap_file import McapFile
from furuta_recordings.bags.mcap_records import BagTopic
from furuta_recordings.bags.metadata import BagFile, information, write_metadata

# Largest chunk [bytes]: a damaged chunk is lost as a whole.
LARGEST_CHUNK = 2**18


class BagWriter:
    """Writes messages into the bag ``path``, which must not exist yet.

    The bag is created under a temporary name and renamed when it is complete. ``parameters`` (file
    name: text) are stored beside the data and in it.
    """

    def __init__(self, path: Path, topics: list[BagTopic], parameters: dict[str, str]) -> None:
        if path.exists():
            raise ParameterError(f"{path} already exists; name another directory for the bag")
        path.parent.mkdir(parents=True, exist_ok=True)
        self.path, self._topics = path, topics
        described = information(topics, [0] * len(topics), [])
        self._metadata = {name: {"text": text} for name, text in parameters.items()}
        self._metadata["rosbag2"] = {"serialized_metadata": described}
        self._finished_files: list[BagFile] = []
        self._finished_counts = [0] * len(topics)
        new = path.with_name(f".{path.name}.new")
        shutil.rmtree(new, ignore_errors=True)
        new.mkdir()
        for name, text in parameters.items():
            (new / name).write_text(text)
        self._file = McapFile(new / self._file_name, topics, self._metadata)
        self._update_metadata(new)
        new.rename(path)

    def add(self, topic: int, time: int, data: bytes) -> None:
        """Take a message of one of the topics (index), received at ``time`` [ns]."""
        self._file.add(topic, time, data)
        if self._file.pending_bytes > LARGEST_CHUNK:
            self.flush()

    def flush(self) -> None:
        """Write all messages taken so far, so that they survive the end of this process."""
        self._file.flush()
        self._update_metadata(self.path)
        if self._file.full:
            self._start_next_file()

    def close(self) -> None:
        """Finish the bag."""
        self._file.close()
        self._update_metadata(self.path)

    @property
    def pending_bytes(self) -> int:
        """Size of the messages that are not on the disk yet [bytes]."""
        return self._file.pending_bytes

    @property
    def _file_name(self) -> str:
        return f"{self.path.name}_{len(self._finished_files)}.mcap"

    @property
    def _current_file(self) -> BagFile:
        file = self._file
        return BagFile(self._file_name, sum(file.counts), file.start, file.end)

    @property
    def _counts(self) -> list[int]:
        return [a + b for a, b in zip(self._finished_counts, self._file.counts, strict=True)]

    def _update_metadata(self, directory: Path) -> None:
        files = [*self._finished_files, self._current_file]
        write_metadata(directory, self._topics, self._counts, files)

    def _start_next_file(self) -> None:
        self._file.close()
        self._finished_counts = self._counts
        self._finished_files.append(self._current_file)
        self._file = McapFile(self.path / self._file_name, self._topics, self._metadata)
        self._update_metadata(self.path)
