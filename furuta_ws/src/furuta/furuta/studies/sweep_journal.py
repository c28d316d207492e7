"""The journal of a study, which lets it continue after a kill.

While a study runs, its results are in a journal beside the output file: a first line that describes
the study, then one line per run. A last line that a kill has cut off is ignored. Results stay in
the file; memory holds where each of them begins.
"""

from __future__ import annotations

import json
from array import array
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from furuta.studies.sweep import RunResult
from furuta_model.parameters import ParameterError
from furuta_sim.simulation.closed_loop import Outcome

# Where the result of a run begins that is not there yet.
_MISSING = -1


class Journal:
    """The results so far by number of the run, in a file that survives a kill.

    ``study`` describes what the results depend on, ``columns`` names what each result has. As a
    container it has the numbers of the runs that are done.
    """

    def __init__(
        self, out: Path, study: NamedTuple, columns: tuple[str, ...] = Outcome._fields
    ) -> None:
        self._path = out.with_name(out.name + ".part")
        self._begins = array("q")
        self._done = 0
        described = study._asdict() | {"columns": columns}
        header = json.dumps(described, default=_plain).encode() + b"\n"
        out.parent.mkdir(parents=True, exist_ok=True)
        self._path.touch()
        self._file = self._path.open("r+b")
        try:
            end = self._read(header, type(study).__name__.lower())
        except ParameterError:
            self._file.close()
            raise
        # An incomplete last line is removed, so that the next result starts on a new line.
        self._file.truncate(end)
        self._file.seek(end)
        if end == 0:
            self._file.write(header)
        self._file.flush()
        self._end = end or len(header)

    def _read(self, header: bytes, kind: str) -> int:
        """Find the results of a killed study; returns where the last complete line ends."""
        first = self._file.readline()
        if not first.endswith(b"\n"):
            return 0
        if first != header:
            raise ParameterError(
                f"{self._path} belongs to another {kind} or version of this program; finish that "
                "one with its own arguments, or delete the file"
            )
        end = len(first)
        for line in self._file:
            if not line.endswith(b"\n"):
                break
            self._note(int(line[1 : line.index(b",")]), end)
            end += len(line)
        return end

    def _note(self, number: int, begin: int) -> None:
        while len(self._begins) <= number:
            self._begins.append(_MISSING)
        self._done += self._begins[number] == _MISSING
        self._begins[number] = begin

    def __contains__(self, number: object) -> bool:
        """Whether a run is done."""
        if not isinstance(number, int) or number >= len(self._begins):
            return False
        return self._begins[number] != _MISSING

    def __len__(self) -> int:
        """The number of runs that are done."""
        return self._done

    def __iter__(self) -> Iterator[int]:
        """The numbers of the runs that are done."""
        return (number for number, begin in enumerate(self._begins) if begin != _MISSING)

    def __getitem__(self, number: int) -> dict[str, Any]:
        """The result of a run that is done."""
        self._file.seek(self._begins[number])
        found: dict[str, Any] = json.loads(self._file.readline())[1]
        return found

    def record(self, results: Iterable[RunResult]) -> Iterator[RunResult]:
        """Write each result to the file, then yield it."""
        for number, result in results:
            line = json.dumps([number, result]).encode() + b"\n"
            self._file.seek(self._end)
            self._file.write(line)
            self._file.flush()
            self._note(number, self._end)
            self._end += len(line)
            yield number, result

    def delete(self) -> None:
        """Delete the file once its results are in the table."""
        self._file.close()
        self._path.unlink()

    def close(self) -> None:
        """Close the file and keep it for the next call."""
        self._file.close()


def _plain(value: Any) -> Any:
    """What JSON has instead of an array or another object."""
    return value.tolist() if isinstance(value, np.ndarray) else str(value)
