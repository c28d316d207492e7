"""Reads the columns of a CSV table as numbers.

Tables of many makes: with or without a byte-order mark, commas, semicolons, tabs or blanks between
the cells, decimal commas, dates in ISO 8601, lines before the header that begin with #.
"""

from __future__ import annotations

import csv
import io
from array import array
from collections.abc import Iterator
from datetime import datetime, timezone
from math import nan
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_ros.yaml_files import open_regular

# Longest line [characters], and most cells of a table: 8 bytes each in memory.
LONGEST_LINE = 2**20
MOST_CELLS = 50_000_000


def csv_columns(path: Path) -> dict[str, np.ndarray]:
    """Every named column (n,); NaN where a cell is empty or not a number; dates in s since 1970."""
    try:
        with io.TextIOWrapper(open_regular(path, "table"), "utf-8-sig", newline="") as file:
            header, columns = _columns(file)
    except UnicodeError:
        raise ParameterError(f"cannot read {path}: not a text file in UTF-8") from None
    except (OSError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or error
        raise ParameterError(f"cannot read {path}: {reason}") from None
    if not header or not columns[0]:
        raise ParameterError(f"{path}: no table in it")
    return {name: np.array(column) for name, column in zip(header, columns, strict=True) if name}


def _columns(file: TextIO) -> tuple[list[str], list[array[float]]]:
    """Header and numbers."""
    lines = _lines(file)
    first = next(lines, "")
    separated = _separated(first)
    header = [name.strip() for name in next(csv.reader([first], **separated), [])]
    columns = [array("d") for _ in header]
    for number, row in enumerate(csv.reader(lines, **separated), 2):
        if any(row[len(header) :]):
            raise csv.Error(
                f"line {number} has {len(row)} cells, the header has {len(header)}; separate cells "
                "by semicolons if numbers have decimal commas"
            )
        if row:
            missing = [""] * (len(header) - len(row))
            for column, cell in zip(columns, row + missing, strict=False):
                column.append(_number(cell))
            if len(columns) * len(columns[0]) > MOST_CELLS:
                raise csv.Error(f"more than {MOST_CELLS} cells")
    return header, columns


def _lines(file: TextIO) -> Iterator[str]:
    """The lines of a file from the header on, none read as a whole before its length is known."""
    in_table = False
    while line := file.readline(LONGEST_LINE + 1):
        if len(line) > LONGEST_LINE:
            raise csv.Error(f"a line has more than {LONGEST_LINE} characters")
        in_table = in_table or not (line.startswith("#") or line.isspace())
        if in_table:
            yield line


def _separated(header: str) -> dict[str, Any]:
    """How cells are separated: comma, semicolon or tab, whichever the header has most, or blank."""
    separator = max(",;\t", key=header.count)
    if separator not in header and " " in header.strip():
        return {"delimiter": " ", "skipinitialspace": True}
    return {"delimiter": separator}


def _number(cell: str) -> float:
    """A number, also with a decimal comma, or a date [s since 1970]; UTC unless it has a zone."""
    try:
        return float(cell)
    except ValueError:
        pass
    try:
        if "," in cell:
            return float(cell.replace(".", "").replace(",", "."))
        date = datetime.fromisoformat(cell.strip().replace("Z", "+00:00"))
    except ValueError:
        return nan
    return (date if date.tzinfo else date.replace(tzinfo=timezone.utc)).timestamp()
