"""Reads the columns of a CSV table as numbers."""

from __future__ import annotations

import csv
import io
from array import array
from collections.abc import Iterator
from math import nan
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_model.regular_files import open_regular

# Longest line [characters], how much of the first one determines the separator, and most cells of a
# table: 8 bytes each in memory.
LONGEST_LINE = 2**20
SEPARATOR_SAMPLE = 4096
MOST_CELLS = 50_000_000


def csv_columns(path: Path) -> dict[str, np.ndarray]:
    """Every named column (n,); NaN where a cell is empty or not a number."""
    try:
        with io.TextIOWrapper(open_regular(path, "table"), newline="") as file:
            header, columns = _columns(file)
    except UnicodeDecodeError:
        raise ParameterError(f"cannot read {path}: not a text file") from None
    except (OSError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or error
        raise ParameterError(f"cannot read {path}: {reason}") from None
    if not header or not columns or not len(columns[0]):
        raise ParameterError(f"{path}: no table in it")
    return {name: np.array(column) for name, column in zip(header, columns, strict=True) if name}


def _columns(file: TextIO) -> tuple[list[str], list[array[float]]]:
    """Header and numbers."""
    dialect = _dialect(file.readline(LONGEST_LINE))
    file.seek(0)
    reader = csv.reader(_lines(file), dialect)
    header = [name.strip() for name in next(reader, [])]
    columns = [array("d") for _ in header]
    for row in reader:
        if row:
            for index, column in enumerate(columns):
                column.append(_number(row, index))
            if len(columns) * len(columns[0]) > MOST_CELLS:
                raise csv.Error(f"more than {MOST_CELLS} cells")
    return header, columns


def _lines(file: TextIO) -> Iterator[str]:
    """The lines of a file, none of which is read as a whole before its length is known."""
    while line := file.readline(LONGEST_LINE + 1):
        if len(line) > LONGEST_LINE:
            raise csv.Error(f"a line has more than {LONGEST_LINE} characters")
        yield line


def _dialect(line: str) -> Any:
    """Comma, semicolon or tab, as the first line has it."""
    try:
        return csv.Sniffer().sniff(line[:SEPARATOR_SAMPLE].splitlines()[0], ",;\t")
    except (csv.Error, IndexError):
        return csv.excel


def _number(row: list[str], index: int) -> float:
    try:
        return float(row[index])
    except (ValueError, IndexError):
        return nan
