"""Text of results: numbers with as many digits as are known, tables of at most 80 columns."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from textwrap import wrap
from typing import Any

from furuta.results.plain import plain

# Characters of a line, of the name of a value, and between two columns.
WIDTH, NAME, GAP = 80, 24, 2
# Characters of a line of a title, and the units in which names end.
TITLE = 12
UNITS = {"_rad_s": "rad/s", "_1_s": "1/s", "_rad": "rad", "_s": "s", "_v": "V"}
# Names whose values are lists of complex numbers, as real and imaginary part.
COMPLEX = ("poles", "zeros", "multipliers")
# What stands beside the values of the same names.
BESIDE = ("standard_errors", "units")
# What stands for a value in a row that has none.
NONE = "–"
# Values that are none.
MISSING: tuple[Any, ...] = (None, [], {}, "")
# A number that was given as text.
_NUMBER = re.compile(r"[-+.\deE]+")


def angle(radians: float) -> str:
    """An angle in rad, and in degrees for people."""
    return f"{radians:.3g} rad ({math.degrees(radians):.3g}°)"


def swing_sentence(peak_to_peak: float, period: float, stuck: float) -> str:
    """How the arm swings: peak to peak [rad], period [s], part of the time in which it sticks.

    NaN is none.
    """
    if math.isnan(period):
        return f"The arm moves by {angle(peak_to_peak)}, without a period."
    sticks = f"; it sticks {100 * stuck:.0f} % of the time" if stuck > 0.0 else ""
    return f"The arm swings by {angle(peak_to_peak)} every {period:.3g} s{sticks}."


def values_text(values: Mapping[str, Any], indent: str = "") -> str:
    """The values, a line each, without those that are not known; lists of rows as tables.

    Where there are ``standard_errors`` and ``units`` by name, they stand beside the values.
    """
    return "\n".join(_lines(plain(values), indent))


def _lines(values: Mapping[str, Any], indent: str) -> Iterator[str]:
    errors, units = (values.get(name) or {} for name in BESIDE)
    for name, value in values.items():
        if value in MISSING or name in BESIDE:
            continue
        title = f"{indent}{escaped(name):<{max(0, NAME - len(indent))}}"
        if isinstance(value, Mapping):
            yield title.rstrip()
            yield from _lines(value, indent + "  ")
        elif isinstance(value, list) and all(isinstance(row, Mapping) for row in value):
            yield title.rstrip()
            yield table_text(value, indent=indent + "  ")
        else:
            error = f" ± {errors[name]:.2g}" if errors.get(name) else ""
            yield from _wrapped(title, f"{_value(name, value)}{error} {units.get(name, '')}")


def _wrapped(title: str, text: str) -> Iterator[str]:
    """The title and the text beside it, which goes on below itself."""
    # A name may be longer than its column; a word longer than the line stays whole.
    room = max(WIDTH - max(len(title), NAME) - 1, WIDTH // 2)
    first, *others = wrap(text, room, break_long_words=False, break_on_hyphens=False) or [""]
    yield f"{title} {first}"
    yield from (f"{'':{NAME}} {line}" for line in others)


def _value(name: str, value: Any) -> str:
    if name.endswith(COMPLEX) and isinstance(value, list):
        return ", ".join(map(_complex, value))
    if isinstance(value, list) and value and isinstance(value[0], list):
        return ", ".join(f"[{rounded(row)}]" for row in value)
    degrees = isinstance(value, float) and name.endswith("_rad")
    return rounded(value) + (f"  ({math.degrees(value):.3g}°)" if degrees else "")


def _complex(parts: Sequence[float | None]) -> str:
    real, imaginary = parts
    return NONE if real is None or imaginary is None else f"{real:.4g}{imaginary:+.4g}j"


def escaped(text: str) -> str:
    """The text with escapes for what a terminal would not print, such as its own commands."""
    return "".join(char if char.isprintable() else ascii(char)[1:-1] for char in text)


def rounded(value: Any) -> str:
    """A value for people: a number with six digits, which is more than is known."""
    if isinstance(value, list | tuple):
        return ", ".join(map(rounded, value)) or "none"
    if value is None:
        return NONE
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else escaped(str(value))


def table_text(
    rows: Iterable[Mapping[str, Any]], headings: Mapping[str, str] | None = None, indent: str = ""
) -> str:
    """Rows as a table: text at the left, numbers with three digits at the right.

    ``headings`` are the names that are shown, with their titles; by default all. Columns beyond the
    width of the text continue below, beside the first one. No value is cut.
    """
    shown: list[dict[str, Any]] = plain(list(rows))
    titles = headings or {name: heading(name) for row in shown for name in row}
    if not titles:
        return ""
    height = max(len(_title_lines(title)) for title in titles.values())
    columns = [_column(title, name, shown, height) for name, title in titles.items()]
    first, room = columns[0], WIDTH - len(indent) - len(columns[0][0]) - GAP
    blocks: list[list[Sequence[str]]] = [[]]
    used = 0
    for column in columns[1:]:
        width = len(column[0]) + GAP
        if blocks[-1] and used + width > room:
            blocks.append([])
            used = 0
        blocks[-1].append(column)
        used += width
    texts = (
        "\n".join(
            indent + (" " * GAP).join(cells).rstrip() for cells in zip(first, *block, strict=True)
        )
        for block in blocks
    )
    return "\n\n".join(texts)


def heading(name: str) -> str:
    """The title of a column: the words of its name, and the unit in which the name ends."""
    end = _end(name)
    unit = f" [{UNITS[end]}]" if end else ""
    return name.removesuffix(end).replace("_", " ") + unit


def unit_of(name: str) -> str:
    """The unit in which a name ends; "" is none."""
    return UNITS.get(_end(name), "")


def _end(name: str) -> str:
    return next((end for end in UNITS if name.endswith(end)), "")


def _title_lines(title: str) -> list[str]:
    """The lines of a title; a unit in brackets stays whole."""
    name, bracket, unit = title.partition(" [")
    return [title] if len(title) <= TITLE else wrap(name, TITLE) + [f"[{unit}"] * bool(bracket)


def _column(title: str, name: str, rows: Sequence[Mapping[str, Any]], height: int) -> list[str]:
    """The lines of a title and the cells of a column, all as wide as the widest."""
    values = [row.get(name) for row in rows]
    lines = _title_lines(title)
    cells = [*[""] * (height - len(lines)), *lines, *map(_cell, values)]
    width = max(map(len, cells))
    is_text = any(isinstance(value, str) and not _NUMBER.fullmatch(value) for value in values)
    return [cell.ljust(width) if is_text else cell.rjust(width) for cell in cells]


def _cell(value: Any) -> str:
    if value in MISSING:
        return NONE
    return f"{value:.3g}" if isinstance(value, float) else rounded(value)
