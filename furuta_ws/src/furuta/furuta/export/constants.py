"""The constants of generated C, each with where it comes from."""

from __future__ import annotations

import inspect
import re
import sys
from functools import cache
from typing import Any

import numpy as np

from furuta.export.text import comment, summary, wrapped
from furuta.export.values import (
    INTEGER,
    KINDS,
    REAL,
    Array,
    Known,
    Number,
    Precision,
    Value,
    integer,
    truth,
)
from furuta_model.parameters import About, group_fields

# Every C has integers up to this; a larger one is written as a number.
LARGEST_INT = 2**15 - 1


class Constants:
    """Turns Python objects into values; keeps the named constants that the values refer to."""

    def __init__(self, precision: Precision) -> None:
        self.precision = precision
        self._definitions: dict[str, tuple[str, str]] = {}
        self._values: dict[str, float] = {}

    def global_value(self, name: str, value: Any, module: str) -> Value:
        """A global of a module."""
        if module == "furuta_model.elementary":
            value = self.precision.constants.get(name, value)
        name = name.strip("_")
        named = name.isupper() and type(value) in (int, float)
        if not named:
            return self.value(value, "", type(value))
        if self._values.setdefault(name, value) != value:
            name = f"{module.rpartition('.')[2].upper()}_{name}"
        if type(value) is int:
            return self._integer(name, value, _remark(name, value, module))
        return self._real(name, value, _remark(name, value, module))

    def field(self, record: Known, name: str) -> Value:
        """A field of a record of the design."""
        hint, _ = _declarations(type(record.value))[name]  # type: ignore[arg-type]
        value = getattr(record.value, name)
        return self.value(value, f"{record.path}_{name}", hint, self.remark(record, name))

    def remark(self, record: Known, name: str) -> str:
        """The comment on a field."""
        kind = type(record.value)
        _, about = _declarations(kind)[name]  # type: ignore[arg-type]
        unit = f" [{about.unit}]" if about and about.unit else ""
        return (f"{about.meaning}{unit}" if about else "") or summary(kind)

    def kind_of(self, record: Known, name: str) -> str:
        """The kind of number that a field holds."""
        hint, _ = _declarations(type(record.value))[name]  # type: ignore[arg-type]
        return KINDS[hint]

    def value(self, value: Any, path: str, kind: Any, remark: str = "") -> Value:
        """A Python object of a declared kind, whose constants are named by ``path``."""
        if isinstance(value, (bool, np.bool_)):
            return truth(bool(value))
        if kind is float and not isinstance(value, type):
            value = float(value)
            literal = Number(REAL, self.precision.literal(value), value=value)
            return self._real(path, value, remark) if path else literal
        if isinstance(value, (int, np.integer)):
            number = int(value)
            named = path and abs(number) <= LARGEST_INT
            return self._integer(path, number, remark) if named else integer(number)
        if isinstance(value, np.ndarray):
            return self._array(path, value, remark)
        return Known(value, path)

    def text(self, code: str) -> str:
        """The definitions of all constants that occur in some code."""
        words = set(re.findall(r"\w+", code))
        lines: list[str] = []
        previous = ""
        for name, (definition, remark) in sorted(self._definitions.items()):
            if name in words:
                lines += [comment(remark)] if remark and remark != previous else []
                lines.append(definition)
                previous = remark
        return "\n".join(lines)

    def _integer(self, name: str, value: int, remark: str) -> Number:
        self._definitions.setdefault(name, (f"enum {{ {name} = {value} }};", remark))
        return Number(INTEGER, name, value=value)

    def _real(self, name: str, value: float, remark: str) -> Number:
        of = self.precision
        definition = f"static const {of.name} {name} = {of.literal(value)};"
        self._definitions.setdefault(name, (definition, remark))
        return Number(REAL, name, value=value)

    def _array(self, name: str, value: np.ndarray, remark: str) -> Array:
        kind = REAL if value.dtype.kind == "f" else INTEGER
        size = "".join(f"[{n}]" for n in value.shape)
        numbers = self._braces(value.tolist())
        definition = f"static const {self.precision.type_of(kind)} {name}{size} = {numbers};"
        self._definitions.setdefault(name, (wrapped(definition), remark))
        return Array(kind, name, is_constant=True, shape=value.shape)

    def _braces(self, value: Any) -> str:
        if isinstance(value, list):
            return "{" + ", ".join(map(self._braces, value)) + "}"
        return self.precision.literal(value) if isinstance(value, float) else str(value)


@cache
def _declarations(kind: type) -> dict[str, tuple[Any, Any]]:
    """Type and declaration as a parameter, if it is one, of each field of a named tuple."""
    return {
        name: (hint, next((mark for mark in marks if isinstance(mark, About)), None))
        for name, hint, marks in group_fields(kind)
    }


@cache
def _remark(name: str, value: float, user: str) -> str:
    """The comment above a constant, in the module that uses it or in that which defines it."""
    pattern = re.compile(rf"((?:^# .*\n)*)^(?:[A-Z_0-9]+, )*{name}\b[^=\n(]*=", re.M)
    ours = [module for key, module in sorted(sys.modules.items()) if key.startswith("furuta")]
    numbers = [m for m in ours if isinstance(getattr(m, name, None), int | float)]
    defining = (module for module in numbers if getattr(module, name) == value)
    for module in (sys.modules[user], *defining):
        if found := pattern.search(inspect.getsource(module)):
            return re.sub(r"(?m)^# |\n$", "", found[1]).replace("\n", " ") or module.__name__
    return ""
