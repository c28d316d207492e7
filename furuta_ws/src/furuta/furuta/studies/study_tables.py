"""Writes the table of a study, a row per run, as CSV or Parquet.

Rows are written as they come, so memory does not grow with their number. The file appears only
when it is complete.
"""

import csv
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from typing import Any, get_type_hints

from furuta_model.parameters import ParameterError
from furuta_recordings.table_files import check_parquet, write_parquet_rows
from furuta_sim.simulation.closed_loop import Outcome

SUFFIXES = (".csv", ".parquet")
# Columns of a run beside its parameters; they are empty if the parameters are impossible.
OUTCOME: dict[str, type] = {**get_type_hints(Outcome), "error": str}

Rows = Iterable[Mapping[str, Any]]


def check_table(out: Path) -> None:
    """Reject a file that exists, or whose format cannot be written."""
    if out.suffix not in SUFFIXES:
        raise ParameterError(f"--out must be a .csv or .parquet file, given {out}")
    if out.suffix == ".parquet":
        check_parquet()
    if out.exists():
        raise ParameterError(f"{out} already exists; name another file with --out")


def write_runs(rows: Rows, out: Path) -> None:
    """Write the rows of runs, parameters and outcome, as CSV or Parquet; the suffix decides."""
    if out.suffix != ".parquet":
        write_csv(rows, out)
        return
    first, rows = _with_first(rows)
    types = {name: OUTCOME.get(name, type(value)) for name, value in first.items()}
    with _complete(out) as path:
        write_parquet_rows(path, types, rows)


def write_csv(rows: Rows, out: Path) -> None:
    """Write at least one row; all have the columns of the first one."""
    first, rows = _with_first(rows)
    with _complete(out) as path, path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(first))
        writer.writeheader()
        writer.writerows(rows)


def _with_first(rows: Rows) -> tuple[Mapping[str, Any], Rows]:
    """The first row, and all rows."""
    iterator = iter(rows)
    first = next(iterator)
    return first, chain([first], iterator)


@contextmanager
def _complete(out: Path) -> Iterator[Path]:
    """A file beside ``out`` that replaces it in the end."""
    out.parent.mkdir(parents=True, exist_ok=True)
    incomplete = out.with_name(out.name + ".new")
    yield incomplete
    incomplete.replace(out)
