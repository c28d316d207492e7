"""The journal of a sweep, which lets it continue after a kill.

While a sweep runs, its results are in a file beside the output: a line that describes the sweep,
and a line of JSON for each run, in order. A kill can cut the last line only, which is dropped.
"""

import json
from collections.abc import Iterable, Iterator
from pathlib import Path

from furuta.outcomes import Outcome
from furuta.studies.sweep import Result, Sweep
from furuta_model.parameters import ParameterError
from furuta_ros.errors import UserError
from furuta_ros.whole_files import make_directory


class Journal:
    """The results so far, in a file that survives a kill; ``count`` is their number.

    The results depend on the ``sweep`` and on what a run measures.
    """

    def __init__(self, out: Path, sweep: Sweep) -> None:
        self._path = out.with_name(out.name + ".part")
        make_directory(out.parent)
        about = json.dumps(sweep._asdict() | {"columns": Outcome._fields}, default=str)
        self._file = self._path.open("a+b")
        self._file.seek(0)
        known = self._file.readline()
        if not known:
            self._write(about)
        elif known != about.encode() + b"\n":
            self._file.close()
            raise ParameterError(
                f"{self._path} belongs to another sweep or version of this program; finish that "
                "one with its own arguments, or delete the file"
            )
        self.count = self._whole_lines() - 1

    def _whole_lines(self) -> int:
        """The number of lines; the end of the file is cut off if it is none."""
        self._file.seek(0)
        sizes = [len(line) for line in self._file if line.endswith(b"\n")]
        self._file.truncate(sum(sizes))
        return len(sizes)

    def _write(self, line: str) -> None:
        """Add a line; the error names the file if it cannot be written, as on a full disk."""
        try:
            self._file.write(line.encode() + b"\n")
            self._file.flush()
        except OSError as error:
            raise UserError(f"{self._path}: {error.strerror}") from None

    def record(self, results: Iterable[Result]) -> Iterator[Result]:
        """Write each result to the file, then yield it."""
        for result in results:
            self._write(json.dumps([self.count, result]))
            self.count += 1
            yield result

    def results(self) -> Iterator[Result]:
        """All results in order. A second process that runs the same sweep may repeat some."""
        self._file.seek(0)
        self._file.readline()
        expected = 0
        for line in self._file:
            number, result = json.loads(line)
            if number == expected:
                yield result
                expected += 1

    def delete(self) -> None:
        """Delete the file once its results are in the table."""
        self._path.unlink(missing_ok=True)

    def close(self) -> None:
        """Close the file and keep it for the next call."""
        self._file.close()
