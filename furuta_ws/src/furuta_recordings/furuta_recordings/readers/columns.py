"""Takes names of columns apart: what is measured, of which joint, and in which unit."""

import re
from collections.abc import Iterable, Mapping
from math import pi
from pathlib import Path
from typing import NamedTuple

import numpy as np

from furuta_model.parameters import ParameterError

_BRACKETS = re.compile(r"^(.*?)\s*[\[(]\s*([^\])]*?)\s*[\])]\s*$")
_ENDING = re.compile(r"^(.*)_([^_]+)$")
_SEPARATORS = re.compile(r"[\s./_:\-]+")

TIME_UNITS = {
    **dict.fromkeys(("s", "sec", "seconds"), 1.0),
    **dict.fromkeys(("ms", "msec"), 1e-3),
    **dict.fromkeys(("us", "µs", "μs"), 1e-6),
    "ns": 1e-9,
    "min": 60.0,
}
ANGLE_UNITS = {
    **dict.fromkeys(("rad", "radians"), 1.0),
    "mrad": 1e-3,
    **dict.fromkeys(("deg", "degrees", "°"), pi / 180.0),
    **dict.fromkeys(("rev", "turns"), 2.0 * pi),
}
SPEED_UNITS = {
    **{f"{unit}/{per}": size for unit, size in ANGLE_UNITS.items() for per in ("s", "sec")},
    **{f"{unit}ps": size for unit, size in ANGLE_UNITS.items() if unit.isalpha()},
    **dict.fromkeys(("rpm", "1/min"), 2.0 * pi / 60.0),
    "1/s": 1.0,
}
COMMAND_UNITS = {**dict.fromkeys(("v", "volt", "volts"), 1.0), "mv": 1e-3}
# Units of an axis: of a position along a straight line, and of a current, torque or force.
LENGTH_UNITS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6}
DRIVE_UNITS = {**COMMAND_UNITS, "a": 1.0, "ma": 1e-3, "nm": 1.0, "n": 1.0}
_UNITS = {*TIME_UNITS, *ANGLE_UNITS, *SPEED_UNITS, *LENGTH_UNITS, *DRIVE_UNITS}
# Names of a time that contain the unit: those of Arduino's functions.
_TIMES = {"millis": "ms", "micros": "us"}

# Last words of the names of an angle and of a speed; the words between joint and speed may be any
# of FILLERS, as in `arm angle dot`.
ANGLE_WORDS = ("position", "angle", "pos", "encoder")
SPEED_WORDS = ("velocity", "speed", "dot", "vel", "rate")
FILLERS = ("angle", "angular", "position", "pos")

# Series (n,) by the name of their column.
Columns = dict[str, np.ndarray]


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
    elif at_end is not None and at_end[2].lower() in _UNITS:
        name, unit = at_end[1], at_end[2]
    words = tuple(word for word in _SEPARATORS.split(name.strip().lower()) if word)
    if not unit and len(words) == 1 and words[0] in _TIMES:
        return Column(("time",), _TIMES[words[0]])
    return Column(words, unit.strip().lower())


def in_si(path: Path, columns: Columns, name: str | None, units: Mapping[str, float]) -> np.ndarray:
    """A column in SI units, if its name tells the unit; NaN for a column that is missing."""
    if name is None:
        return np.full(len(next(iter(columns.values()))), np.nan)
    unit = column(name).unit
    if unit and unit not in units:
        raise ParameterError(
            f"{path}: the unit of column {name} is not one of {', '.join(units)}; rename the column"
        )
    return columns[name] * units.get(unit, 1.0)


def joint_names(columns: Iterable[str]) -> list[str]:
    """Names of joints in columns such as /joint_states/NAME/position, NAME_angle, `Name angle`.

    The joint is all but the last word of the path's last part. A part that is only the word for
    the angle belongs to the joint that is named before it.
    """
    names: dict[str, None] = {}
    for name in columns:
        words = column(name).words
        if len(words) > 1 and words[-1] in ANGLE_WORDS:
            parts = [part for part in name.replace(".", "/").split("/") if part]
            own = column(parts[-1]).words
            names["_".join(own[:-1]) or parts[-2]] = None
    return list(names)


def joint_column(columns: Iterable[str], joint: str, endings: tuple[str, ...]) -> str | None:
    """The first column named after the joint and one of the endings."""
    wanted = column(joint).words
    for name in columns:
        words = column(name).words
        if len(words) < 2 or words[-1] not in endings:
            continue
        rest = words[:-1]
        while rest and rest[-1] in FILLERS and rest[-len(wanted) :] != wanted:
            rest = rest[:-1]
        if rest[-len(wanted) :] == wanted:
            return name
    return None
