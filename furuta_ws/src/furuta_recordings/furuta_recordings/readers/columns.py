"""Takes names of columns apart: what is measured, of which joint, and in which unit."""

import re
from collections.abc import Iterable, Mapping
from math import pi
from typing import NamedTuple

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_recordings.csv_columns import DATE, DAY_TIME, HOUR_TIME, INSTANT, Table

_BRACKETS = re.compile(r"^(.*?)\s*[\[(]\s*([^\])]*?)\s*[\])]\s*$")
# A unit in the last one, two or three parts of a name: time_ms, vel_rad_s, vel_rad_per_s.
_ENDINGS = [re.compile(rf"^(.*)_([^_]+{'_[^_]+' * parts})$") for parts in (2, 1, 0)]
_SEPARATORS = re.compile(r"[\s./_:\-]+")

TIME_UNITS = {
    **dict.fromkeys(("s", "sec", "seconds"), 1.0),
    **dict.fromkeys(("ms", "msec"), 1e-3),
    **dict.fromkeys(("us", "µs", "μs"), 1e-6),
    "ns": 1e-9,
    "min": 60.0,
    **dict.fromkeys((DATE, DAY_TIME, HOUR_TIME, INSTANT), 1.0),
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
LENGTH_UNITS = {
    **dict.fromkeys(("m", "meter", "meters", "metre", "metres"), 1.0),
    "cm": 1e-2,
    "mm": 1e-3,
    **dict.fromkeys(("um", "µm"), 1e-6),
}
# An encoder's counts stay counts.
TORQUE_UNITS = {"nm": 1.0, "mnm": 1e-3, "ncm": 1e-2, "kgfcm": 0.0980665, "kgcm": 0.0980665}
FORCE_UNITS = {"n": 1.0, "mn": 1e-3}
DRIVE_UNITS = {**COMMAND_UNITS, "a": 1.0, "ma": 1e-3, **TORQUE_UNITS, **FORCE_UNITS}
COUNT_UNITS = dict.fromkeys(("counts", "count", "cts", "ticks"), 1.0)
POSITION_UNITS = {**ANGLE_UNITS, **LENGTH_UNITS, **COUNT_UNITS}
AXIS_SPEED_UNITS = {**SPEED_UNITS, **{f"{u}/s": s for u, s in (LENGTH_UNITS | COUNT_UNITS).items()}}
_UNITS = {*TIME_UNITS, *POSITION_UNITS, *AXIS_SPEED_UNITS, *DRIVE_UNITS}
# Names of a time that contain the unit: those of Arduino's functions.
_TIMES = {"millis": "ms", "micros": "us"}

# Units in which an axis is described, by those of a column that are not units of their own.
AXIS_UNITS = {
    **dict.fromkeys(ANGLE_UNITS, "rad"),
    **dict.fromkeys(LENGTH_UNITS, "m"),
    **dict.fromkeys(COUNT_UNITS, "counts"),
    **dict.fromkeys(COMMAND_UNITS, "V"),
    **dict.fromkeys(("a", "ma"), "A"),
    **dict.fromkeys(TORQUE_UNITS, "N m"),
    **dict.fromkeys(FORCE_UNITS, "N"),
}

# Last words of the names of an angle and of a speed; the words between joint and speed may be any
# of FILLERS, as in `arm angle dot`.
ANGLE_WORDS = ("position", "angle", "pos", "encoder")
SPEED_WORDS = ("velocity", "speed", "dot", "vel", "rate")
DRIVE_WORDS = ("torque", "force", "current", "voltage", "effort")
FILLERS = ("angle", "angular", "position", "pos")


class Column(NamedTuple):
    """A column's words in lower case, without its unit, and its unit; empty if it has none."""

    words: tuple[str, ...]
    unit: str


def column(name: str) -> Column:
    """The words and the unit of ``name``: a unit in brackets, or at the end as in ``time_ms``."""
    unit = ""
    in_brackets = _BRACKETS.match(name)
    at_end = (ending.match(name) for ending in _ENDINGS)
    known = next((match for match in at_end if match and _unit(match[2]) in _UNITS), None)
    found = in_brackets if in_brackets and not in_brackets[2].isdigit() else known
    if found:  # a number in brackets is that of an element
        name, unit = found[1], found[2]
    words = tuple(word for word in _SEPARATORS.split(name.strip().lower()) if word)
    if not unit and len(words) == 1 and words[0] in _TIMES:
        return Column(("time",), _TIMES[words[0]])
    return Column(words, _unit(unit))


def _unit(text: str) -> str:
    """A unit as the tables above write it: N·m, N-m and N_m are nm, rad_s and rad_per_s rad/s."""
    text = text.strip().lower()
    text = text.replace("_per_", "/").replace("_", "/")
    return re.sub(r"(n|kgf?)/(c?m)$", r"\1\2", re.sub(r"[\s·⋅*.-]", "", text))


def unit_of(table: Table, name: str) -> str:
    """The unit of a column, in its name or below it."""
    text = table.units.get(name, "")
    if text in (DATE, DAY_TIME, HOUR_TIME, INSTANT):
        return text
    own, below = column(name).unit, _unit(text.strip("[]()-"))
    if below in (*ANGLE_WORDS, *SPEED_WORDS, *DRIVE_WORDS):
        below = ""  # a second name
    if own and below and own != below:
        raise ParameterError(f"{table.path}: column {name} has another unit below, {below}")
    return own or below


def values_of(table: Table, name: str) -> np.ndarray:
    """A column; raises ParameterError if it cannot be used."""
    if name in table.problems:
        raise ParameterError(f"{table.path}: {table.problems[name]}")
    return table.columns[name]


def listed(table: Table) -> str:
    """What a table has, for a message."""
    others = [text for name, text in table.problems.items() if name not in table.columns]
    return ", ".join([*table.columns, *others]) or "no columns"


def in_si(table: Table, name: str | None, units: Mapping[str, float]) -> np.ndarray:
    """A column in SI units, if its unit is known; NaN for a column that is missing."""
    if name is None:
        return np.full(len(next(iter(table.columns.values()))), np.nan)
    unit = unit_of(table, name)
    if unit and unit not in units:
        raise ParameterError(
            f"{table.path}: the unit of column {name} is not one of {', '.join(units)}; rename the "
            "column"
        )
    return values_of(table, name) * units.get(unit, 1.0)


def joint_names(columns: Iterable[str]) -> list[str]:
    """Names of joints in columns such as /joint_states/NAME/position, NAME_angle, `Name angle`.

    The joint is all but the last word of the path's last part, in lower case. A part that is only
    the word for the angle belongs to the joint that is named before it.
    """
    names: dict[str, None] = {}
    for name in columns:
        words = column(name).words
        if len(words) > 1 and words[-1] in ANGLE_WORDS:
            parts = [part for part in name.replace(".", "/").split("/") if part]
            own = column(parts[-1]).words
            names["_".join(own[:-1]) or parts[-2].lower()] = None
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
