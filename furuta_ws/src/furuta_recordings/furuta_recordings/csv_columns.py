"""Reads the columns of a CSV table as numbers.

Tables of many makes: UTF-8, UTF-16 with its mark, or Windows' western encoding; commas, semicolons,
tabs or blanks between the cells; decimal commas; dates and times of day; a row of units below the
header; lines that begin with #, of which the last one can be the header; other lines above it.
"""

from __future__ import annotations

import csv
import re
from array import array
from collections import Counter
from collections.abc import Iterator, Sequence
from datetime import date
from itertools import chain, islice, pairwise
from math import isnan, nan
from pathlib import Path
from typing import Any, NamedTuple, TextIO

import numpy as np

from furuta_model.parameters import ParameterError, shortened

# Most cells of a table: 8 bytes each in memory.
MOST_CELLS = 50_000_000
# Rows that are read together; more do not stay in the processor's cache.
ROWS_TOGETHER = 256
# Last line in which the header of a table may be.
HIGHEST_HEADER = 40
# What stands for a missing value; an empty cell does too.
MISSING = {"", "-", "--", "na", "n/a", "#n/a", "nan", "nil", "none", "null"}
# Kinds of time, which are the units of their columns.
DATE, DAY_TIME, HOUR_TIME, INSTANT = "date", "time of day", "min:s", "date and time"
_DECIMAL_COMMA = re.compile(r"[+-]?(?=,?\d)\d*,\d*(?:e[+-]?\d+)?")
# With a decimal comma these have three decimals; they may be thousands as well.
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")
_TIME = re.compile(
    r"(?:(?P<date>\d{4}[-/.]\d{1,2}[-/.]\d{1,2}|\d{1,2}[./]\d{1,2}[./]\d{4})(?:[t_\s]+|$))?"
    r"(?:(?P<clock>\d+:\d\d(?::\d\d)?)(?P<part>[.,]\d+)?\s*(?P<half>[ap]m)?)?"
    r"\s*(?:z|utc|(?P<zone>[+-]\d\d:?\d\d))?"
)
# A number with a unit of time, as MATLAB writes durations.
_DURATION = re.compile(r"(?P<number>[+-]?[\d.]+(?:e[+-]?\d+)?)\s*(?P<unit>sec|s|ms|min)")
_EPOCH = date(1970, 1, 1).toordinal()


# How pictures begin: PNG, JPEG, GIF, and figures as PDF.
PICTURES = (b"\x89PNG", b"\xff\xd8\xff", b"GIF8", b"%PDF")


class Table(NamedTuple):
    """Columns (n,) by name, NaN where a cell is empty; those in ``problems`` cannot be used.

    ``units`` are those that stand below the names, or the kind of time that a column holds.
    """

    path: Path
    columns: dict[str, np.ndarray]
    problems: dict[str, str]
    units: dict[str, str]


def read_csv(path: Path, names: Sequence[str] = ()) -> Table:
    """The columns of a table; times in s, since 1970 if they have a date.

    ``names`` are those of the columns of a table without a header.
    """
    for encoding in _encodings(path):
        try:
            with path.open(encoding=encoding, newline="") as file:
                return _table(path, file, names)
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
    if start.startswith(PICTURES):
        raise ParameterError(f"cannot read {path}: it is a picture or a PDF file, not a recording")
    if start.startswith((b"\xff\xfe", b"\xfe\xff")):
        return ("utf-16",)
    return () if b"\0" in start else ("utf-8-sig", "cp1252")


def _table(path: Path, file: TextIO, names: Sequence[str]) -> Table:
    head = [*islice(file, HIGHEST_HEADER + 2)]
    above, begin = (0, 0) if names else _lines_above(head)
    read = _header(chain(head[above:], file), above, names)
    header, number, separated, lines = read
    cells = [Cells(name.strip()) for name in header]
    ignored = [header]
    numbered = _rows(csv.reader(lines, **separated), number, ignored, begin)
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


def _lines_above(head: Sequence[str]) -> tuple[int, int]:
    """How many of the first lines stand above the header, and the line where numbers begin; or 0.

    The header is one text row, or one with units below, directly above two rows of numbers.
    """
    for separator in ";\t,":
        rows = [[cell.strip() for cell in row] for row in csv.reader(head, delimiter=separator)]
        if len(rows) != len(head):  # a quoted cell goes on in the next line
            continue
        full = [k for k, row in enumerate(rows) if any(row) and not row[0].startswith("#")]
        for at, (k, after) in enumerate(pairwise(full)):
            width = len(rows[k])
            if (
                width > 1
                and width == len(rows[after])
                and all(map(_is_numbers, (rows[k], rows[after])))
            ):
                names = at
                while (
                    names and len(rows[full[names - 1]]) == width and is_text(rows[full[names - 1]])
                ):
                    names -= 1
                one = 0 < at - names <= 2 and names > 0
                return (full[names] if one else 0), k + 1
    return 0, 0


def _is_numbers(cells: Sequence[str]) -> bool:
    known = [cell.lower() for cell in cells if cell.lower() not in MISSING]
    return bool(known) and not any(isnan(Cells("").number(text, 0)) for text in known)


def _header(
    file: Iterator[str], number: int, given: Sequence[str]
) -> tuple[list[str], int, dict[str, Any], Iterator[str]]:
    """The header, the number of its line, how cells are separated, and the lines below.

    ``number`` lines stand above what is read; a table without a header has the names ``given``.
    """
    comment, separator, first = "", "", ""
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
    if given:
        if is_text(header):
            raise csv.Error(f"line {number} names the columns: leave out --columns")
        if len(header) != len(given):
            raise csv.Error(
                f"line {number} has {len(header)} cells, --columns names {len(given)} columns"
            )
        return list(given), number - 1, separated, chain([first], file)
    if is_text(header) or not header:
        return header, number, separated, file
    names = next(csv.reader([comment], **separated), [])
    if len(names) == len(header) and is_text(names):
        return names, number - 1, separated, chain([first], file)
    raise csv.Error(
        f"line {number} holds numbers, where the names of the columns should stand: give them with "
        "--columns NAME,NAME,..."
    )


def _rows(
    rows: Any, first: int, ignored: list[list[str]], numbers: int
) -> Iterator[tuple[int, list[str]]]:
    """The numbers of lines that hold something, and their rows, of the header's width.

    Left out are comments, and the rows ``ignored``, which a logger repeats at each start. Rows of
    numbers begin in line ``numbers``, if they were found.
    """
    width = len(ignored[0])
    for read in rows:
        line = first + rows.line_num
        row = read if len(read) == width else _fitted(read, width, line, numbers)
        if any(row) and not row[0].startswith("#") and row not in ignored:
            yield line, row


def _fitted(row: list[str], width: int, line: int, numbers: int) -> list[str]:
    if any(row[width:]):
        advice = "separate cells by semicolons if numbers have decimal commas"
        if line < numbers:
            advice = (
                f"numbers begin in line {numbers}: leave one line above them, with the names of "
                "the columns, such as time_ms"
            )
        raise csv.Error(f"line {line} has {len(row)} cells, the header has {width}; {advice}")
    return row[:width] + [""] * (width - len(row))


def _separated(header: str) -> dict[str, Any]:
    """How cells are separated: comma, semicolon or tab, whichever the header has most, or blank."""
    separator = max(",;\t", key=header.count)
    if separator not in header and " " in header.strip():
        return {"delimiter": " ", "skipinitialspace": True}
    return {"delimiter": separator}


class Cells:
    """The cells of the column ``name`` so far: ``numbers``, and what was noticed of the texts."""

    def __init__(self, name: str) -> None:
        self.name, self.numbers = name, array("d")
        # Whether a cell has a decimal point, or a comma that is certainly a decimal one.
        self.has_point = self.has_comma = False
        self._doubtful = 0  # numbers such as 1,234
        self._times: Counter[str] = Counter()
        self._durations: Counter[str] = Counter()
        self._days: dict[str, int] = {}
        # Dates with slashes: whether a day or a month is certainly first, or one was guessed to be.
        self._day_is_first = self._month_is_first = self._guessed = False
        self._wrong, self._first = 0, ""

    def add(self, cells: Sequence[str], lines: Sequence[int]) -> None:
        """Add cells, and the numbers of their lines in the file."""
        together = "".join(cells)
        plain = cells
        if self.has_comma and "." not in together:
            plain = [cell.replace(",", ".") for cell in cells]
        try:
            self.numbers.extend([*map(float, plain)])
            self.has_point |= "." in together
        except ValueError:
            for cell, line in zip(cells, lines, strict=True):
                self.numbers.append(self.number(cell, line))

    def number(self, cell: str, line: int) -> float:
        """The number or the time [s since 1970, or of the day] in a cell; NaN without one."""
        text = cell.strip().lower()
        if text in MISSING:
            return nan
        readers = [self._with_point, self._with_comma, self._duration]
        readers.insert(0 if self._times else 2, self._time)  # first among times, for speed
        for read in readers:
            if (value := read(text)) is not None:
                return value
        self._first = self._first or f"{shortened(cell)} in line {line}"
        self._wrong += 1
        return nan

    def _with_point(self, text: str) -> float | None:
        try:
            value = float(text)
        except ValueError:
            return None
        self.has_point |= "." in text
        return value

    def _with_comma(self, text: str) -> float | None:
        if not _DECIMAL_COMMA.fullmatch(text):
            return None
        if _THOUSANDS.fullmatch(text):
            self._doubtful += 1
        else:
            self.has_comma = True
        return float(text.replace(",", "."))

    def _duration(self, text: str) -> float | None:
        found = _DURATION.fullmatch(text)
        if not found:
            return None
        self._durations[found["unit"]] += 1
        return self._with_point(found["number"])

    def is_doubtful(self, others_have_commas: bool) -> bool:
        """Whether commas may separate thousands.

        They are decimal if another column has decimal commas and all numbers three decimals.
        """
        decimal = others_have_commas and self._doubtful == np.sum(np.isfinite(self.numbers))
        return self._doubtful > 0 and not (self.has_comma or decimal)

    def _time(self, text: str) -> float | None:
        found = _TIME.fullmatch(text)
        if not found or not (found["date"] or found["clock"]):
            return None
        day = self._day(found["date"]) if found["date"] else 0
        if day is None:
            return None
        kind, seconds = DATE, 0.0
        if found["clock"]:
            kind, seconds = _clock(found["clock"], found["part"], found["half"])
            kind = INSTANT if found["date"] else kind
        self._times[kind] += 1
        return 86400.0 * day + seconds - _zone(found["zone"])

    def _day(self, text: str) -> int | None:
        """Days since 1970; of two numbers before a year the first is the month if slashes do."""
        if text not in self._days:
            first, second, third = map(int, re.split("[-/.]", text))
            year, month, day = (first, second, third) if first > 31 else (third, second, first)
            if "/" in text and first <= 31:
                self._day_is_first |= first > 12
                self._month_is_first |= second > 12
                if not self._day_is_first:
                    month, day, self._guessed = first, second, True
            try:
                self._days[text] = date(year, month, day).toordinal() - _EPOCH
            except ValueError:
                return None
        return self._days[text]

    @property
    def unit(self) -> str:
        """The kind of time in the column; empty for numbers."""
        return next(iter(self._times or self._durations), "")

    def problem(self, commas: bool) -> str:
        """Why the column cannot be used; empty if it can. The table has decimal ``commas`` or not.

        A number with a point in a table with decimal commas may be a thousand.
        """
        column, times = f"column {self.name}", self._times.total()
        mixed = len(self._times) > 1 or times < np.sum(np.isfinite(self.numbers))
        either_order = self._guessed and (self._day_is_first or not self._month_is_first)
        problems = {
            f"a cell in {column} is not a number: {self._first}": self._wrong == 1,
            f"{self._wrong} cells in {column} are not numbers, first {self._first}": self._wrong,
            f"{column} has times of several forms, or times and numbers": times and mixed,
            f"{column} has several units": len(self._durations) > 1
            or 0 < self._durations.total() < np.sum(np.isfinite(self.numbers)),
            f"{column} has decimal points, but the table has decimal commas": (
                commas and self.has_point and not times
            ),
            f"{column}: a number such as 1,234 may be a thousand or have decimals; write its "
            "numbers without separators of thousands": self.is_doubtful(commas),
            f"{column}: day and month of {next(iter(self._days), '')} are not certain; write dates "
            "as 2026-01-31": either_order and len(self._days) > 1,
        }
        return next((text for text, holds in problems.items() if holds), "")


def _clock(text: str, part: str | None, half: str | None) -> tuple[str, float]:
    """Kind of a time of day, and its seconds; of two numbers with a fraction min and s."""
    numbers = [int(number) for number in text.split(":")]
    kind = HOUR_TIME if part and len(numbers) == 2 else DAY_TIME
    hour, minute, second = [0, *numbers] if kind == HOUR_TIME else [*numbers, 0][:3]
    if half:
        hour = hour % 12 + 12 * (half == "pm")
    return kind, 3600.0 * hour + 60.0 * minute + second + float((part or "0").replace(",", "."))


def _zone(text: str | None) -> float:
    """Seconds that local time is ahead of UTC."""
    if not text:
        return 0.0
    size = 3600.0 * int(text[1:3]) + 60.0 * int(text[-2:])
    return -size if text[0] == "-" else size


def is_text(cells: Sequence[str]) -> bool:
    """Whether the cells hold neither a number nor a time, but something, as in a row of units."""
    texts = [cell.strip().lower() for cell in cells if cell.strip()]
    known = [text for text in texts if text not in MISSING]
    return bool(known) and all(isnan(Cells("").number(text, 0)) for text in known)
