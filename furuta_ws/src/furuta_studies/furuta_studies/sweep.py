"""A study: many closed loops over some parameters, kept as they come, gone on with after a kill.

Until all runs are done their results are in a journal beside the output: a first line that says
what is studied, then a line for each run. A line that was cut short by a kill does not count.
"""

from __future__ import annotations

import csv
import json
from collections import deque
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple, TextIO

from furuta_analysis.simulation.batch import batch
from furuta_analysis.simulation.closed_loop import Loop, Outcome
from furuta_graph.settings import Settings, loop, with_values
from furuta_model.parameters import ParameterError
from furuta_studies.sweep_points import Axis, Point, design, size_of

NO_OUTCOME = dict.fromkeys(Outcome._fields)

# A run's number, and what it came to or why it cannot be.
Result = tuple[int, dict[str, Any]]


class Study(NamedTuple):
    """What is tried on what."""

    settings: Settings
    axes: tuple[Axis, ...]
    method: str
    points: int
    seed: int
    seconds: float

    @property
    def size(self) -> int:
        """How many runs."""
        return size_of(self.axes, self.method, self.points)

    def design(self) -> Iterator[Point]:
        """The point of every run."""
        return design(self.axes, self.method, self.points, self.seed)

    def loops(self, done: set[int]) -> Iterator[tuple[int, Loop | str]]:
        """The loop of every run that is not ``done``, or why there is none."""
        for number, point in enumerate(self.design()):
            if number not in done:
                try:
                    yield number, loop(with_values(self.settings, point))
                except ParameterError as error:
                    yield number, str(error)


def succeeded(number: int, outcome: Outcome) -> Result:
    """The result of a run."""
    return number, {**outcome._asdict(), "error": ""}


def failed(number: int, reason: str) -> Result:
    """The result of a run that its parameters do not allow."""
    return number, {**NO_OUTCOME, "error": reason}


def run_here(study: Study, done: set[int]) -> Iterator[Result]:
    """Results of the runs that are not ``done``, on all cores."""
    numbers: deque[int] = deque()
    refused: deque[Result] = deque()

    def possible() -> Iterator[Loop]:
        for number, made in study.loops(done):
            if isinstance(made, str):
                refused.append(failed(number, made))
            else:
                numbers.append(number)
                yield made

    for outcome in batch(possible(), study.seconds):
        yield succeeded(numbers.popleft(), outcome)
        while refused:
            yield refused.popleft()
    yield from refused


class Journal:
    """The results so far, in a file that survives a kill."""

    def __init__(self, out: Path, study: Study) -> None:
        self._path = out.with_name(out.name + ".part")
        self._about = json.dumps(study._asdict(), default=str)
        self.results: dict[int, dict[str, Any]] = {}
        out.parent.mkdir(parents=True, exist_ok=True)
        if self._path.exists():
            self._read()
        self._file: TextIO = self._path.open("w" if not self.results else "a")
        if not self.results:
            self._file.write(self._about + "\n")

    def _read(self) -> None:
        text = self._path.read_text()
        about, *lines = text.split("\n")
        if about != self._about:
            raise ParameterError(
                f"{self._path} holds the beginning of another study; finish that one with its own "
                "arguments, or remove the file"
            )
        whole = [line for line in lines[:-1] if line]
        self.results = dict(json.loads(line) for line in whole)
        # What was cut short goes, so that the next line begins where a line begins.
        self._path.write_text("\n".join([about, *whole, ""]))

    def keep(self, results: Iterable[Result]) -> Iterator[Result]:
        """Hand results on once they are written."""
        for number, result in results:
            self._file.write(json.dumps([number, result]) + "\n")
            self._file.flush()
            self.results[number] = result
            yield number, result

    def finish(self) -> None:
        """End the journal: the results are elsewhere."""
        self._file.close()
        self._path.unlink()

    def close(self) -> None:
        """Leave the journal for another time."""
        self._file.close()


def write_table(rows: list[dict[str, Any]], out: Path) -> None:
    """Rows as CSV, whole or not at all."""
    whole = out.with_name(out.name + ".new")
    with whole.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    whole.replace(out)
