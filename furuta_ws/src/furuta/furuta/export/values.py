"""What an expression is while a function is translated: its C text, or what is known of it.

A number that is known when the code is generated selects what is generated: the branch of an
``if``. Its text is the name of a constant or a literal.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np

from furuta_model.parameters import ParameterError

# Kinds of numbers. BITS are those of a real, as an unsigned integer.
REAL, INTEGER, TRUTH, BITS = "real", "integer", "truth", "bits"
# Kinds by the type that a field declares.
KINDS = {float: REAL, int: INTEGER, bool: TRUTH}


class Rank(IntEnum):
    """How tightly C's operators bind, up to names and calls."""

    CHOICE, OR, AND, BIT_OR, BIT_AND, EQUAL, ORDER, SHIFT, SUM, PRODUCT, UNARY, ATOM = range(12)


class Precision(NamedTuple):
    """A C type of reals: its name, the suffix of literals and of functions, its unsigned integer.

    ``constants`` are those of :mod:`furuta_model.elementary` that differ from the double's.
    """

    name: str
    suffix: str
    bits: str
    constants: dict[str, float]

    def type_of(self, kind: str) -> str:
        """The C type of a kind of number."""
        return {REAL: self.name, INTEGER: "int64_t", TRUTH: "bool", BITS: self.bits}[kind]

    def literal(self, value: float) -> str:
        """A real as a literal that this type reads back to the last bit."""
        if math.isnan(value):
            return "NAN"
        if self.suffix:
            value = np.float32(value)  # type: ignore[assignment]
        if math.isinf(value):
            return "INFINITY" if value > 0 else "-INFINITY"
        return str(value) + self.suffix if self.suffix else repr(value)


def _float_constants() -> dict[str, float]:
    """The reduction of the elementary functions for 24 bits."""
    halves = {"LN2": math.log(2.0), "QUARTER_TURN": math.pi / 2.0}
    split = {name: float(np.float32(value)) for name, value in halves.items()}
    rests = {f"{name}_REST": halves[name] - split[name] for name in halves}
    limits = {"LOWEST": -87.0, "HIGHEST": 88.0}
    return {"FRACTION_BITS": 23, "BIAS": 127, "ROUND": 1.5 * 2.0**23, **split, **rests, **limits}


# Words of C that can be names in Python.
C_WORDS = re.compile(
    "auto|bool|case|char|const|default|do|double|enum|extern|float|goto|inline|int|long|register|"
    "restrict|short|signed|sizeof|static|struct|switch|typedef|union|unsigned|void|volatile"
)

DOUBLE = Precision("double", "", "uint64_t", {})
FLOAT = Precision("float", "f", "uint32_t", _float_constants())


class ExportError(ParameterError):
    """Something cannot be translated to C; ``located``: the message says where."""

    def __init__(self, message: str, located: bool = False) -> None:
        super().__init__(message)
        self.located = located


def usable(name: str) -> str:
    """The name, unless C has another meaning for it."""
    if C_WORDS.fullmatch(name):
        raise ExportError(f"{name} is a word of C; rename it")
    return name


class Number(NamedTuple):
    """A number: its C expression, the rank of that, and its value if it is known."""

    kind: str
    text: str
    rank: Rank = Rank.ATOM
    value: Any = None

    @property
    def is_constant(self) -> bool:
        """Whether the number is known and needs no arithmetic."""
        return self.value is not None and (self.kind != REAL or self.rank == Rank.ATOM)

    def within(self, rank: Rank) -> str:
        """The text, in parentheses if it binds less than an operand of this rank must."""
        return self.text if self.rank >= rank else f"({self.text})"


class Array(NamedTuple):
    """An array of numbers; ``shape`` is that of a constant one."""

    kind: str
    text: str
    is_constant: bool = False
    shape: tuple[int, ...] = ()


class Memory(NamedTuple):
    """A structure of the kind of a dataclass: a pointer to it, and how its fields are reached."""

    kind: type
    text: str
    fields: str
    is_constant: bool = False


class Group(NamedTuple):
    """A tuple of values; ``kind`` is the class of a named tuple."""

    values: tuple[Any, ...]
    kind: Any = None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the values."""
        return (
            self.kind._fields if self.kind else tuple(f"part{i}" for i in range(len(self.values)))
        )


class Known(NamedTuple):
    """A Python object that is known: a function, a module, a record of the design at a path."""

    value: Any
    path: str = ""
    is_constant: bool = True


Value = Number | Array | Memory | Group | Known


def truth(value: bool) -> Number:
    """A known truth."""
    return Number(TRUTH, "true" if value else "false", value=bool(value))


def integer(value: int) -> Number:
    """A known integer."""
    return Number(INTEGER, str(value), Rank.ATOM if value >= 0 else Rank.UNARY, int(value))


def leaves(value: Any, name: str) -> Iterator[tuple[str, Any]]:
    """Everything in a value that is no group, with names."""
    if isinstance(value, Group):
        for part, each in zip(value.names, value.values, strict=True):
            yield from leaves(each, f"{name}_{part}" if name else part)
    elif value is not None:
        yield name, value


def inner(value: Any) -> list[Any]:
    """The leaves themselves."""
    return [leaf for _, leaf in leaves(value, "")]


def rebuilt(value: Any, parts: Iterator[Any]) -> Any:
    """The same groups with other leaves."""
    if isinstance(value, Group):
        return value._replace(values=tuple(rebuilt(each, parts) for each in value.values))
    return value if value is None else next(parts)
