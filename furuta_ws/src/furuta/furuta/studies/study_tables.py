"""The table of a study, a row per run: as columns, or as a CSV or Parquet file.

Rows are written as they come, so memory does not grow with their number. The file appears only
when it is complete.
"""

import csv
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields
from itertools import chain
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np

from furuta.outcomes import Outcome
from furuta_model.parameters import ParameterError
from furuta_recordings.suffixes import TABLE_SUFFIXES
from furuta_recordings.table_files import parquet_library, write_parquet_rows
from furuta_ros.whole_files import whole_file

Row = Mapping[str, Any]
SIZE = "phi_peak_to_peak_rad"
# Rows that are remembered to be shown.
FIRST = 10
# Columns of a run beside its parameters; they are empty if the parameters are impossible.
OUTCOME: dict[str, Any] = {**{each.name: each.type for each in fields(Outcome)}, "error": str}


def check_table(out: Path) -> None:
    """Reject a file that exists, or whose format cannot be written."""
    if out.suffix.lower() not in TABLE_SUFFIXES:
        raise ParameterError(f"{out} does not end in {', '.join(TABLE_SUFFIXES)}")
    if out.suffix.lower() == ".parquet":
        parquet_library()
    if out.exists():
        raise ParameterError(f"{out} already exists; name another file with --out")


def write_runs(rows: Iterable[Mapping[str, Any]], out: Path) -> None:
    """Write the rows of runs, parameters and outcome, as CSV or Parquet; the suffix decides.

    There is at least one row, and all have the columns of the first one.
    """
    rows = iter(rows)
    first = next(rows)
    every = chain([first], rows)
    with whole_file(out) as new:
        if out.suffix.lower() == ".parquet":
            types = {name: OUTCOME.get(name, type(value)) for name, value in first.items()}
            write_parquet_rows(new, types, every)
        else:
            with new.open("w", newline="", encoding="utf-8") as file:
                writer = csv.DictWriter(file, list(first))
                writer.writeheader()
                writer.writerows(every)


class Passed:
    """What is remembered of runs that pass by, a row by name each.

    ``runs``, ``fell`` and ``impossible`` are numbers, ``reason`` why the first of these is. The
    arm's swing is ``smallest`` and ``largest`` in these rows. ``first`` are the first rows.
    """

    def __init__(self, parameters: Iterable[str]) -> None:
        self.parameters = list(parameters)
        self.runs = self.fell = self.impossible = 0
        self.reason = ""
        self.smallest: Row | None = None
        self.largest: Row | None = None
        self.first: list[Row] = []

    def passing(self, rows: Iterable[Row]) -> Iterator[Row]:
        """The rows."""
        for row in rows:
            self.runs += 1
            self.fell += bool(row["fell"])
            self.impossible += bool(row["error"])
            self.reason = self.reason or row["error"]
            if len(self.first) < FIRST:
                self.first.append(row)
            if not (row["error"] or row["fell"]):
                point = {name: row[name] for name in (*self.parameters, SIZE)}
                self.smallest = min(self.smallest or point, point, key=itemgetter(SIZE))
                self.largest = max(self.largest or point, point, key=itemgetter(SIZE))
            yield row


def columns(rows: Iterable[Mapping[str, Any]]) -> dict[str, np.ndarray]:
    """The rows as columns (n,) by name, in which NaN is no value."""
    rows = list(rows)
    return {name: _column([row[name] for row in rows]) for name in (rows or [{}])[0]}


def _column(values: list[Any]) -> np.ndarray:
    """An array (n,), of objects if the values are lists."""
    column = np.array([np.nan if value is None else value for value in values])
    if column.ndim > 1:
        column = np.empty(len(values), object)
        column[:] = values
    return column
