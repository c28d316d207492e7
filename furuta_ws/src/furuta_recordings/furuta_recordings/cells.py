"""Numbers from the texts in the cells of one column, or why they are none."""

import re
from array import array
from collections import Counter
from collections.abc import Sequence
from datetime import date
from math import isnan, nan

import numpy as np

from furuta_model.parameters import shortened

# What stands for a missing value; an empty cell does too.
MISSING = {"", "-", "--", "na", "n/a", "#n/a", "nan", "nil", "none", "null"}
# Kinds of time, which are the units of their columns.
DATE, DAY_TIME, HOUR_TIME, INSTANT = "date", "time of day", "min:s", "date and time"
_DECIMAL_COMMA = re.compile(r"[+-]?(?=,?\d)(?:\d*|[1-9]\d{0,2}(?:\.\d{3})+)(?:,\d*)?(?:e[+-]?\d+)?")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(?:,\d{3})+(?:\.\d*)?")
_TIME = re.compile(
    r"(?:(?P<date>\d{4}[-/.]\d{1,2}[-/.]\d{1,2}|\d{1,2}[./]\d{1,2}[./]\d{4})(?:[t_\s]+|$))?"
    r"(?:(?P<clock>\d+:\d\d(?::\d\d)?)(?P<part>[.,]\d+)?\s*(?P<half>[ap]m)?)?"
    r"\s*(?:z|utc|(?P<zone>[+-]\d\d:?\d\d))?"
)
_EPOCH = date(1970, 1, 1).toordinal()


class Cells:
    """The cells of the column ``name`` so far: ``numbers``, and what was noticed about the texts.

    A number such as 1,234 is read with a decimal comma; :meth:`with_thousands` reads it anew.
    """

    def __init__(self, name: str) -> None:
        self.name, self.numbers = name, array("d")
        # Whether a cell can be read in one way only: with a decimal comma, with thousands; and
        # whether one has a decimal point.
        self.has_decimal_comma = self.has_thousands = self.has_point = False
        self.is_doubtful = False
        self._either = array("q"), array("d")
        self._grouped_by_points = ""
        self._times: Counter[str] = Counter()
        self._days: dict[str, int] = {}
        # Dates with slashes: whether a day or a month is certainly first, or one was guessed to be.
        self._day_is_first = self._month_is_first = self._guessed = False
        self._wrong, self._first = 0, ""

    def add(self, cells: Sequence[str], lines: Sequence[int]) -> None:
        """Add cells, and the numbers of their lines in the file."""
        plain = cells
        if self.has_decimal_comma and "." not in "".join(cells):
            plain = [cell.replace(",", ".") for cell in cells]
        try:
            self.numbers.extend([*map(float, plain)])
        except ValueError:
            for cell, line in zip(cells, lines, strict=True):
                self.numbers.append(self.number(cell, line))

    def number(self, cell: str, line: int) -> float:
        """The number or the time [s since 1970, or of the day] in a cell; NaN without one."""
        text = cell.strip().lower()
        if text in MISSING:
            return nan
        readers = [self._with_point, self._with_commas]
        if self.has_decimal_comma:  # among them a point separates thousands
            readers.reverse()
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

    def _with_commas(self, text: str) -> float | None:
        decimal, thousands = _DECIMAL_COMMA.fullmatch(text), _THOUSANDS.fullmatch(text)
        grouped = float(text.replace(",", "")) if thousands else None
        if decimal and grouped is not None:
            rows, values = self._either
            rows.append(len(self.numbers))
            values.append(grouped)
        elif decimal and text.count(".") > 1:
            self._grouped_by_points = text
        elif decimal and not self.has_decimal_comma:
            self.has_point |= len(self._fractions) > 0
            self.has_decimal_comma = True
        self.has_thousands |= bool(thousands and not decimal)
        return float(text.replace(".", "").replace(",", ".")) if decimal else grouped

    @property
    def is_ambiguous(self) -> bool:
        """Whether commas may separate thousands or decimals."""
        return bool(self._either[0]) and not (self.has_decimal_comma or self.has_thousands)

    @property
    def has_three_decimals(self) -> bool:
        """Whether all numbers would have three decimals if commas were decimal."""
        return len(self._either[0]) == np.sum(np.isfinite(self.numbers))

    def with_thousands(self) -> None:
        """Read all commas as separators of thousands."""
        for row, value in zip(*self._either, strict=True):
            self.numbers[row] = value

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
        return next(iter(self._times), "")

    def problem(self) -> str:
        """Why the column cannot be used; empty if it can."""
        column, times = f"column {self.name}", self._times.total()
        mixed = len(self._times) > 1 or times < np.sum(np.isfinite(self.numbers))
        either_order = self._guessed and (self._day_is_first or not self._month_is_first)
        points = self.has_thousands or self.has_point
        problems = {
            f"a cell in {column} is not a number: {self._first}": self._wrong == 1,
            f"{self._wrong} cells in {column} are not numbers, first {self._first}": self._wrong,
            f"points in {column} separate thousands, as in {self._grouped_by_points}; write its "
            "numbers without them": self._grouped_by_points,
            f"{column} has times of several forms, or times and numbers": times and mixed,
            f"{column} has decimal commas in some cells, not in others": (
                self.has_decimal_comma and points
            ),
            f"{column}: a number such as 1,234 or 1.234 may be a thousand or have decimals; write "
            "its numbers without separators of thousands": self.is_doubtful,
            f"{column}: day and month of {next(iter(self._days), '')} are not certain; write dates "
            "as 2026-01-31": either_order and len(self._days) > 1,
        }
        return next((text for text, holds in problems.items() if holds), "")

    @property
    def has_certain_points(self) -> bool:
        """Whether the column has points that cannot separate thousands."""
        return self.has_point or (len(self._fractions) > 0 and not self.may_have_thousands)

    @property
    def may_have_thousands(self) -> bool:
        """Whether all that looks like a decimal point may separate thousands, as in 1.234."""
        values = np.abs(self._fractions)
        thousands = 1000.0 * values
        # From 1000 on they would have two points.
        inside = (values >= 1.0) & (values < 1000.0)
        exact = np.abs(thousands - np.round(thousands)) < 1e-6
        return len(values) > 0 and bool(np.all(inside & exact))

    @property
    def _fractions(self) -> np.ndarray:
        """The numbers that are not whole, of cells without commas."""
        values = np.array(self.numbers)
        values[np.array(self._either[0])] = nan
        chosen: np.ndarray = values[np.isfinite(values) & (values != np.round(values))]
        return chosen[:0] if self.has_decimal_comma or self.unit else chosen


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
