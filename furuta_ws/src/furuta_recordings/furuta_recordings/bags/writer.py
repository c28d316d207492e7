"""A bag that survives: rosbag2 directory with MCAP files that are complete at every moment."""

from __future__ import annotations

import shutil
from pathlib import Path

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.mcap_file import Kind, McapFile
from furuta_recordings.bags.metadata import Part, write_metadata

# Bytes that wait at most: a chunk that is damaged is lost whole.
LARGEST_CHUNK = 2**18


class BagWriter:
    """Writes messages into ``path``, which must not exist.

    The bag is made under another name and appears whole; ``parameters`` (file name: text) are
    laid beside its data and into it.
    """

    def __init__(self, path: Path, kinds: list[Kind], parameters: dict[str, str]) -> None:
        if path.exists():
            raise ParameterError(f"{path} exists already; name another directory for the bag")
        path.parent.mkdir(parents=True, exist_ok=True)
        self.path, self._kinds = path, kinds
        self._metadata = {name: {"text": text} for name, text in parameters.items()}
        self._done: list[Part] = []
        self._counts = [0] * len(kinds)
        new = path.with_name(f".{path.name}.new")
        shutil.rmtree(new, ignore_errors=True)
        new.mkdir()
        for name, text in parameters.items():
            (new / name).write_text(text)
        self._file = McapFile(new / self._name, kinds, self._metadata)
        write_metadata(new, kinds, self._counts, [self._part])
        new.rename(path)

    def add(self, kind: int, time: int, data: bytes) -> None:
        """Take a message of one of the kinds (index), received at ``time`` [ns]."""
        self._file.add(kind, time, data)
        if self._file.waiting > LARGEST_CHUNK:
            self.flush()

    def flush(self) -> None:
        """Make all that was taken last beyond this process's end."""
        self._file.flush()
        self._note()
        if self._file.full:
            self._next()

    def close(self) -> None:
        """Finish the bag."""
        self._file.close()
        self._note()

    @property
    def waiting(self) -> int:
        """Bytes that do not last yet."""
        return self._file.waiting

    @property
    def _name(self) -> str:
        return f"{self.path.name}_{len(self._done)}.mcap"

    @property
    def _part(self) -> Part:
        file = self._file
        return Part(self._name, sum(file.counts), file.start, file.end)

    def _note(self) -> None:
        counts = [a + b for a, b in zip(self._counts, self._file.counts, strict=True)]
        write_metadata(self.path, self._kinds, counts, [*self._done, self._part])

    def _next(self) -> None:
        self._file.close()
        self._counts = [a + b for a, b in zip(self._counts, self._file.counts, strict=True)]
        self._done.append(self._part)
        self._file = McapFile(self.path / self._name, self._kinds, self._metadata)
        self._note()
