"""Reads the columns of a CSV table as numbers.

Tables of any make: a byte-order mark, UTF-16, commas, semicolons, tabs or blanks between the cells,
decimal commas, dates in ISO 8601, lines before the header that begin with #.
"""

from __future__ import annotations

import codecs
import csv
import io
from array import array
from collections.abc import Iterator
from datetime import timezone
from math import nan
from pathlib import Path
from typing import Any, BinaryIO, TextIO

import numpy as np
from dateutil.parser import isoparse

from furuta_model.parameters import ParameterError
from furuta_ros.regular_files import open_regular

# Longest line [characters], how much of the first one determines the separator, and most cells of a
# table: 8 bytes each in memory.
LONGEST_LINE = 2**20
SEPARATOR_SAMPLE = 4096
MOST_CELLS = 50_000_000
# Shortest date, 2026-01-31.
SHORTEST_DATE = 10


def csv_columns(path: Path) -> dict[str, np.ndarray]:
    """Every named column (n,); NaN where a cell is empty or not a number; dates in s since 1970."""
    try:
        with open_regular(path, "table") as binary:
            encoding = _encoding(binary)
            with io.TextIOWrapper(binary, encoding=encoding, newline="") as file:
                header, columns = _columns(file)
    except UnicodeError:
        raise ParameterError(f"cannot read {path}: not a text file in UTF-8 or UTF-16") from None
    except (OSError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or error
        raise ParameterError(f"cannot read {path}: {reason}") from None
    if not header or not columns or not len(columns[0]):
        raise ParameterError(f"{path}: no table in it")
    return {name: np.array(column) for name, column in zip(header, columns, strict=True) if name}


def _encoding(file: BinaryIO) -> str:
    """UTF-16 if the file begins with its byte-order mark, otherwise UTF-8 with or without one."""
    mark = file.read(2)
    file.seek(0)
    return "utf-16" if mark in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE) else "utf-8-sig"


def _columns(file: TextIO) -> tuple[list[str], list[array[float]]]:
    """Header and numbers."""
    lines = _lines(file)
    first = next(lines, "")
    separated = _separated(first)
    header = [name.strip() for name in next(csv.reader([first], **separated), [])]
    reader = csv.reader(lines, **separated)
    columns = [array("d") for _ in header]
    for row in reader:
        if row:
            _check_length(row, header, reader.line_num)
            for index, column in enumerate(columns):
                column.append(_number(row, index))
            if len(columns) * len(columns[0]) > MOST_CELLS:
                raise csv.Error(f"more than {MOST_CELLS} cells")
    return header, columns


def _check_length(row: list[str], header: list[str], line: int) -> None:
    """Raise if a row has more values than the header has names."""
    if any(row[len(header) :]):
        raise csv.Error(
            f"line {line + 1} has {len(row)} cells, the header has {len(header)}; separate cells "
            "by semicolons if numbers have decimal commas"
        )


def _lines(file: TextIO) -> Iterator[str]:
    """The lines of a file from the header on, none read as a whole before its length is known."""
    in_table = False
    while line := file.readline(LONGEST_LINE + 1):
        if len(line) > LONGEST_LINE:
            raise csv.Error(f"a line has more than {LONGEST_LINE} characters")
        in_table = in_table or not (line.startswith("#") or line.isspace())
        if in_table:
            yield line


def _separated(line: str) -> dict[str, Any]:
    """How cells are separated: comma, semicolon or tab, whichever the header has most, or blank."""
    separator = max(",;\t", key=line[:SEPARATOR_SAMPLE].count)
    if separator not in line and " " in line.strip():
        return {"delimiter": " ", "skipinitialspace": True}
    return {"delimiter": separator}


def _number(row: list[str], index: int) -> float:
    try:
        return float(row[index])
    except ValueError:
        return _unusual_number(row[index].strip())
    except IndexError:
        return nan


def _unusual_number(cell: str) -> float:
    """A number with a decimal comma, or a date [s since 1970]; UTC unless it names a zone."""
    if "," in cell:
        try:
            return float(cell.replace(".", "").replace(",", "."))
        except ValueError:
            pass  # it may be a date with a decimal comma
    if len(cell) < SHORTEST_DATE or not cell[:4].isdigit():
        return nan
    try:
        date = isoparse(cell.replace(" ", "T", 1))
    except ValueError:
        return nan
    return (date if date.tzinfo else date.replace(tzinfo=timezone.utc)).timestamp()
