"""Reads the columns of a CSV table as numbers.

Tables of many makes: UTF-8, UTF-16 with its mark, or Windows' western encoding; commas, semicolons,
tabs or blanks between the cells; decimal commas; dates and times of day; a row of units below the
header; lines that begin with #, of which the last one can be the header.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from itertools import chain, islice
from pathlib import Path
from typing import Any, NamedTuple, TextIO

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_recordings.cells import Cells, is_text

# Most cells of a table: 8 bytes each in memory.
MOST_CELLS = 50_000_000
# Rows that are read together; more do not stay in the processor's cache.
ROWS_TOGETHER = 256


class Table(NamedTuple):
    """Columns (n,) by name, NaN where a cell is empty; those in ``problems`` cannot be used.

    ``units`` are those that stand below the names, or the kind of time that a column holds.
    """

    path: Path
    columns: dict[str, np.ndarray]
    problems: dict[str, str]
    units: dict[str, str]


def read_csv(path: Path) -> Table:
    """The named columns of a table; times in s, since 1970 if they have a date."""
    for encoding in _encodings(path):
        try:
            with path.open(encoding=encoding, newline="") as file:
                return _table(path, file)
        except UnicodeError:
            continue
        except (OSError, csv.Error) as error:
            reason = getattr(error, "strerror", None) or error
            raise ParameterError(f"cannot read {path}: {reason}") from None
    raise ParameterError(
        f"cannot read {path}: not a text file in UTF-8, or in UTF-16 with a byte-order mark"
    )


def _encodings(path: Path) -> tuple[str, ...]:
    """Encodings to try."""
    with path.open("rb") as file:
        start = file.read(4096)
    if start.startswith(b"PK\x03\x04"):
        raise ParameterError(f"cannot read {path}: a zip archive or workbook, not a text file")
    if start.startswith((b"\xff\xfe", b"\xfe\xff")):
        return ("utf-16",)
    return () if b"\0" in start else ("utf-8-sig", "cp1252")


def _table(path: Path, file: TextIO) -> Table:
    header, number, separated, lines = _header(file)
    cells = [Cells(name.strip()) for name in header]
    ignored = [header]
    numbered = _rows(csv.reader(lines, **separated), number, ignored)
    first = [*islice(numbered, 1)]
    if first and is_text(first[0][1]):
        ignored.append(first.pop()[1])
    numbered = chain(first, numbered)
    while batch := [*islice(numbered, ROWS_TOGETHER)]:
        numbers, rows = zip(*batch, strict=True)
        for column, texts in zip(cells, zip(*rows, strict=True), strict=True):
            column.add(texts, numbers)
        if len(cells) * len(cells[0].numbers) > MOST_CELLS:
            raise csv.Error(f"more than {MOST_CELLS} cells")
    if not cells or not len(cells[0].numbers):
        raise ParameterError(
            f"{path}: no table in it" + (", no row of numbers below a header" if cells else "")
        )
    units = ignored[-1] if len(ignored) > 1 else [""] * len(cells)
    below = {column.name: unit.strip() for column, unit in zip(cells, units, strict=True)}
    return _named(path, cells, below)


def _named(path: Path, cells: list[Cells], units: dict[str, str]) -> Table:
    """The table of the columns that have a name."""
    table = Table(path, {}, {}, units)
    commas = any(column.has_comma for column in cells)
    for column in cells:
        values, name = np.array(column.numbers), column.name
        if not name:
            continue
        problem = column.problem(commas)
        again = table.columns.get(name, values)
        if not np.array_equal(again, values, equal_nan=True):
            problem = f"column {name} is there twice, with different values; rename one"
        if problem:
            table.problems[name] = problem
        if column.unit:
            table.units[name] = column.unit
        table.columns[name] = values
    return table


def _header(file: TextIO) -> tuple[list[str], int, dict[str, Any], Iterator[str]]:
    """The header, the number of its line, how cells are separated, and the lines below."""
    comment, separator, number, first = "", "", 0, ""
    for first in file:
        number += 1
        if first.startswith("#"):
            comment = first[1:].strip()
        elif first.lower().startswith("sep="):
            separator = first[4:5]
        elif not first.isspace():
            break
    separated = {"delimiter": separator} if separator else _separated(first)
    header = next(csv.reader([first], **separated), [])
    if is_text(header) or not header:
        return header, number, separated, file
    names = next(csv.reader([comment], **separated), [])
    if len(names) == len(header) and is_text(names):
        return names, number - 1, separated, chain([first], file)
    raise csv.Error(f"line {number} holds numbers, where the names of the columns should stand")


def _rows(rows: Any, first: int, ignored: list[list[str]]) -> Iterator[tuple[int, list[str]]]:
    """The numbers of lines that hold something, and their rows, of the header's width.

    Left out are comments, and the rows ``ignored``, which a logger repeats at each start.
    """
    width = len(ignored[0])
    for read in rows:
        line = first + rows.line_num
        row = read if len(read) == width else _fitted(read, width, line)
        if any(row) and not row[0].startswith("#") and row not in ignored:
            yield line, row


def _fitted(row: list[str], width: int, line: int) -> list[str]:
    if any(row[width:]):
        raise csv.Error(
            f"line {line} has {len(row)} cells, the header has {width}; separate cells by "
            "semicolons if numbers have decimal commas"
        )
    return row[:width] + [""] * (width - len(row))


def _separated(header: str) -> dict[str, Any]:
    """How cells are separated: comma, semicolon or tab, whichever the header has most, or blank."""
    separator = max(",;\t", key=header.count)
    if separator not in header and " " in header.strip():
        return {"delimiter": " ", "skipinitialspace": True}
    return {"delimiter": separator}
