"""Numbers from the texts in the cells of one column, or why they are none."""

import re
from array import array
from collections.abc import Sequence
from datetime import date
from math import isnan, nan

import numpy as np

from furuta_model.parameters import shortened

# What stands for a missing value; an empty cell does too.
MISSING = ("", "-", "--", "na", "n/a", "#n/a", "nan", "nil", "none", "null")
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
        self._either = array("q"), array("d")
        self._times: dict[str, int] = {}
        self._days: dict[str, int] = {}
        # Dates of which the month may be first, and whether the day is first in another one.
        self._guessed: set[str] = set()
        self._day_is_first = False
        self._grouped_by_points = ""
        self._wrong, self._first = 0, ""

    def add(self, cells: Sequence[str], lines: Sequence[int]) -> None:
        """Add cells, and the numbers of their lines in the file."""
        try:
            self.numbers.extend([*map(float, cells)])
        except ValueError:
            for cell, line in zip(cells, lines, strict=True):
                self.numbers.append(self.number(cell, line))

    def number(self, cell: str, line: int) -> float:
        """The number or the time [s since 1970, or of the day] in a cell; NaN without one."""
        if not cell:
            return nan
        if self._times and (value := self._time(cell.lower())) is not None:
            return value
        has_point = "." in cell
        try:
            if not self.has_decimal_comma:
                number = float(cell)
                self.has_point |= has_point
                return number
            if not has_point:
                return float(cell.replace(",", "."))
        except ValueError:
            pass
        return self._from_text(cell.strip(), line)

    def _from_text(self, cell: str, line: int) -> float:
        text = cell.lower()
        if text in MISSING:
            return nan
        value = self._with_commas(text)
        value = self._time(text) if value is None else value
        if value is None and self.has_decimal_comma:
            value = self._with_point(text)
        if value is None:
            self._first = self._first or f"{shortened(cell)} in line {line}"
            self._wrong += 1
            return nan
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
            self.has_decimal_comma = True
            self.has_point |= bool(len(fractions(self.numbers)))
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

    def _with_point(self, text: str) -> float | None:
        try:
            value = float(text)
        except ValueError:
            return None
        self.has_point = True
        return value

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
        self._times[kind] = self._times.get(kind, 0) + 1
        return 86400.0 * day + seconds - _zone(found["zone"])

    def _day(self, text: str) -> int | None:
        """Days since 1970; of two numbers before a year the first is the month if slashes do."""
        if text not in self._days:
            first, second, third = map(int, re.split("[-/.]", text))
            year, month, day = (first, second, third) if first > 31 else (third, second, first)
            self._day_is_first |= "/" in text and 12 < first <= 31
            if "/" in text and first <= 12 and not self._day_is_first:
                month, day = first, second
                self._guessed.add(text)
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
        if self._wrong == 1:
            return f"a cell in column {self.name} is not a number: {self._first}"
        if self._wrong:
            return f"{self._wrong} cells in column {self.name} are not numbers, first {self._first}"
        return self._problem_with_separators() or self._problem_with_times()

    def _problem_with_separators(self) -> str:
        if self._grouped_by_points:
            return (
                f"points in column {self.name} separate thousands, as in {self._grouped_by_points};"
                " write its numbers without them"
            )
        if self.has_decimal_comma and (self.has_thousands or self.has_point):
            return f"column {self.name} has decimal commas in some cells, not in others"
        return ""

    def _problem_with_times(self) -> str:
        times = sum(self._times.values())
        if times and (len(self._times) > 1 or times < np.sum(np.isfinite(self.numbers))):
            return f"column {self.name} has times of several forms, or times and numbers"
        if len(self._days) > 1 and self._order_is_open():
            return (
                f"column {self.name}: day and month of {next(iter(self._days))} are not certain; "
                "write dates as 2026-01-31"
            )
        return ""

    def _order_is_open(self) -> bool:
        """Whether the month was taken to be first in a date, and no other one proves it."""
        proven = any(int(day.split("/")[1]) > 12 for day in self._guessed)
        return bool(self._guessed) and (self._day_is_first or not proven)


def fractions(numbers: Sequence[float]) -> np.ndarray:
    """The numbers that are not whole."""
    values = np.array(numbers)
    chosen: np.ndarray = values[np.isfinite(values) & (values != np.round(values))]
    return chosen


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
