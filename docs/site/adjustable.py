"""Constants of which some can be changed while the loop runs: numbers of one array in C."""

from __future__ import annotations

from typing import Any

import numpy as np

from furuta.export.constants import Constants
from furuta.export.values import INTEGER, REAL, TRUTH, Array, Known, Number, Precision, Value

_IN_C = {
    REAL: "({array}[{place}])",
    INTEGER: "((int64_t){array}[{place}])",
    TRUTH: "({array}[{place}] != 0.0)",
}


def numbers_of(record: Any, path: str) -> dict[str, Any]:
    """All numbers and arrays in a record of the design, by the names that they have in C."""
    if not hasattr(record, "_fields"):
        return {path: record}
    return {
        name: value
        for field in record._fields
        for name, value in numbers_of(getattr(record, field), f"{path}_{field}").items()
    }


class Adjustable(Constants):
    """Turns Python objects into values; those in ``places`` are read from an array.

    ``places`` gives the index of the first number in ``array``, by the name in C.
    """

    def __init__(self, precision: Precision, places: dict[str, int], array: str) -> None:
        super().__init__(precision)
        self.places = places
        self.array = array

    def field(self, record: Known, name: str) -> Value:
        """A field of a record of the design."""
        path = f"{record.path}_{name}"
        if path not in self.places:
            return super().field(record, name)
        given, remark = getattr(record.value, name), self.remark(record, name)
        if isinstance(given, np.ndarray):
            return self._part(path, given.shape, remark)
        kind = self.kind_of(record, name)
        self._define(path, _IN_C[kind], remark)
        return Number(kind, path)

    def _part(self, path: str, shape: tuple[int, ...], remark: str) -> Array:
        """A part of the array, as an array of this shape."""
        rows = "".join(f"[{n}]" for n in shape[1:])
        pointer = f"({self.precision.name} (*){rows})" if rows else ""
        self._define(path, f"({pointer}({{array}} + {{place}}))", remark)
        return Array(REAL, path, is_constant=True, shape=shape)

    def _define(self, name: str, text: str, remark: str) -> None:
        text = text.format(array=self.array, place=self.places[name])
        self._definitions.setdefault(name, (f"#define {name} {text}", remark))
