"""Takes names of columns apart: what is measured, and in which unit."""

import re
from math import pi
from typing import NamedTuple

_BRACKETS = re.compile(r"^(.*?)\s*[\[(]\s*([^\])]*?)\s*[\])]\s*$")
_ENDING = re.compile(r"^(.*)_([^_]+)$")
_SEPARATORS = re.compile(r"[\s./_:\-]+")

TIME_UNITS = {
    "s": 1.0,
    "sec": 1.0,
    "seconds": 1.0,
    "ms": 1e-3,
    "msec": 1e-3,
    "us": 1e-6,
    "µs": 1e-6,
    "μs": 1e-6,
    "ns": 1e-9,
    "min": 60.0,
}
ANGLE_UNITS = {
    "rad": 1.0,
    "radians": 1.0,
    "mrad": 1e-3,
    "deg": pi / 180.0,
    "degrees": pi / 180.0,
    "°": pi / 180.0,
    "rev": 2.0 * pi,
    "turns": 2.0 * pi,
}
SPEED_UNITS = {
    **{f"{unit}/{per}": size for unit, size in ANGLE_UNITS.items() for per in ("s", "sec")},
    **{f"{unit}ps": size for unit, size in ANGLE_UNITS.items() if unit.isalpha()},
    "rpm": 2.0 * pi / 60.0,
    "1/min": 2.0 * pi / 60.0,
    "1/s": 1.0,
}
# Names of a time that contain the unit: those of Arduino's functions.
_TIMES = {"millis": "ms", "micros": "us"}
COMMAND_UNITS = {"v": 1.0, "volt": 1.0, "volts": 1.0, "mv": 1e-3}


class Column(NamedTuple):
    """A column's words in lower case, without its unit, and its unit; empty if it has none."""

    words: tuple[str, ...]
    unit: str


def column(name: str) -> Column:
    """The words and the unit of ``name``: a unit in brackets, or at the end as in ``time_ms``."""
    unit = ""
    in_brackets, at_end = _BRACKETS.match(name), _ENDING.match(name)
    if in_brackets is not None:
        name, unit = in_brackets[1], in_brackets[2]
    elif at_end is not None and _is_unit(at_end[2]):
        name, unit = at_end[1], at_end[2]
    words = tuple(word for word in _SEPARATORS.split(name.strip().lower()) if word)
    if not unit and len(words) == 1 and words[0] in _TIMES:
        return Column(("time",), _TIMES[words[0]])
    return Column(words, unit.strip().lower())


def _is_unit(text: str) -> bool:
    text = text.lower()
    return any(text in units for units in (TIME_UNITS, ANGLE_UNITS, SPEED_UNITS, COMMAND_UNITS))
