"""The journal of a study, which lets it continue after a kill, and its final table.

While a sweep or comparison runs, its results are in a journal beside the output file: a first line
that describes the study, then one line per run. A last line that a kill has cut off is ignored.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple, TextIO

from furuta_model.parameters import ParameterError
from furuta_studies.sweep import RunResult


class Journal:
    """The results so far, in a file that survives a kill.

    ``study`` describes what the results depend on.
    """

    def __init__(self, out: Path, study: NamedTuple) -> None:
        self._kind = type(study).__name__.lower()
        self._path = out.with_name(out.name + ".part")
        self._header = json.dumps(study._asdict(), default=str)
        self.results: dict[int, dict[str, Any]] = {}
        out.parent.mkdir(parents=True, exist_ok=True)
        if self._path.exists():
            self._read()
        self._file: TextIO = self._path.open("w" if not self.results else "a")
        if not self.results:
            self._file.write(self._header + "\n")

    def _read(self) -> None:
        header, *lines = self._path.read_text().split("\n")
        if header != self._header:
            raise ParameterError(
                f"{self._path} belongs to another {self._kind}; finish that one with its own "
                "arguments, or delete the file"
            )
        complete = [line for line in lines[:-1] if line]
        self.results = dict(json.loads(line) for line in complete)
        # An incomplete last line is removed, so that the next result starts on a new line.
        self._path.write_text("\n".join([header, *complete, ""]))

    def record(self, results: Iterable[RunResult]) -> Iterator[RunResult]:
        """Write each result to the file, then yield it."""
        for number, result in results:
            self._file.write(json.dumps([number, result]) + "\n")
            self._file.flush()
            self.results[number] = result
            yield number, result

    def delete(self) -> None:
        """Delete the file once its results are in the table."""
        self._file.close()
        self._path.unlink()

    def close(self) -> None:
        """Close the file and keep it for the next call."""
        self._file.close()


def write_table(rows: list[dict[str, Any]], out: Path) -> None:
    """Write rows as CSV; the file appears only when it is complete."""
    incomplete = out.with_name(out.name + ".new")
    with incomplete.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    incomplete.replace(out)
