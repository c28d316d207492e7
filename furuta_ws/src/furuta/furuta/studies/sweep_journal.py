"""The journal of a sweep, which lets it continue after a kill.

While a sweep runs, its results are in an SQLite file beside the output: a description of the sweep,
and one row per run. A result is there entirely or not at all, whenever the process is killed.
"""

import json
import sqlite3
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from furuta.studies.sweep import RunResult, Sweep
from furuta_model.parameters import ParameterError
from furuta_ros.errors import UserError
from furuta_sim.simulation.closed_loop import Outcome

# A commit need not survive a loss of power, only of the process. The write-ahead log disappears
# when the journal is closed.
SCHEMA = """
PRAGMA journal_mode = WAL;
PRAGMA synchronous = OFF;
CREATE TABLE IF NOT EXISTS sweep (description TEXT);
CREATE TABLE IF NOT EXISTS runs (number INTEGER PRIMARY KEY, result TEXT);
"""


class Journal:
    """The results so far by number of the run, in a file that survives a kill.

    The results depend on the ``sweep`` and on what a run measures. As a container the journal has
    the numbers of the runs that are done.
    """

    def __init__(self, out: Path, sweep: Sweep) -> None:
        self._path = out.with_name(out.name + ".part")
        out.parent.mkdir(parents=True, exist_ok=True)
        description = json.dumps(sweep._asdict() | {"columns": Outcome._fields}, default=str)
        with self._explained():
            self._file = sqlite3.connect(self._path, isolation_level=None, check_same_thread=False)
            known = self._description(description)
        if known != description:
            self._file.close()
            raise ParameterError(
                f"{self._path} belongs to another sweep or version of this program; finish that "
                "one with its own arguments, or delete the file"
            )

    def _description(self, new: str) -> str:
        """What the journal describes; an empty one describes the ``new`` sweep from now on."""
        try:
            self._file.executescript(SCHEMA)
            known = self._file.execute("SELECT description FROM sweep").fetchone()
        except sqlite3.OperationalError:
            raise
        except sqlite3.DatabaseError:
            return "not a journal"
        if known is None:
            self._file.execute("INSERT INTO sweep VALUES (?)", (new,))
            return new
        return str(known[0])

    @contextmanager
    def _explained(self) -> Iterator[None]:
        """Name the file if it cannot be opened or written, as on a full disk."""
        try:
            yield
        except sqlite3.OperationalError as error:
            raise UserError(f"{self._path}: {error}") from None

    def __contains__(self, number: object) -> bool:
        """Whether a run is done."""
        query = "SELECT 1 FROM runs WHERE number = ?"
        return self._file.execute(query, (number,)).fetchone() is not None

    def __len__(self) -> int:
        """The number of runs that are done."""
        (count,) = self._file.execute("SELECT count(*) FROM runs").fetchone()
        return int(count)

    def __getitem__(self, number: int) -> dict[str, Any]:
        """The result of a run that is done."""
        query = "SELECT result FROM runs WHERE number = ?"
        result: dict[str, Any] = json.loads(self._file.execute(query, (number,)).fetchone()[0])
        return result

    def record(self, results: Iterable[RunResult]) -> Iterator[RunResult]:
        """Write each result to the file, then yield it."""
        for number, result in results:
            row = number, json.dumps(result)
            with self._explained():
                self._file.execute("INSERT OR REPLACE INTO runs VALUES (?, ?)", row)
            yield number, result

    def delete(self) -> None:
        """Delete the file once its results are in the table."""
        self._file.close()
        self._path.unlink()

    def close(self) -> None:
        """Close the file and keep it for the next call."""
        self._file.close()
