"""Operators and functions of C that do what those of the compiled Python do, to the last bit.

Division is that of IEEE 754. ``min``, ``max`` and comparisons treat NaN as Python does. The only
functions of math.h are those that IEEE 754 defines to the last bit.
"""

from __future__ import annotations

import ast
import builtins
import math
import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from furuta.export.values import (
    BITS,
    INTEGER,
    REAL,
    TRUTH,
    ExportError,
    Number,
    Precision,
    Rank,
    truth,
)
from furuta_model import elementary

BINARY: dict[type, tuple[str, Rank, Callable[[Any, Any], Any]]] = {
    ast.Add: ("+", Rank.SUM, operator.add),
    ast.Sub: ("-", Rank.SUM, operator.sub),
    ast.Mult: ("*", Rank.PRODUCT, operator.mul),
    ast.Div: ("/", Rank.PRODUCT, operator.truediv),
    ast.LShift: ("<<", Rank.SHIFT, operator.lshift),
    ast.BitAnd: ("&", Rank.BIT_AND, operator.and_),
    ast.BitOr: ("|", Rank.BIT_OR, operator.or_),
}
COMPARISON: dict[type, tuple[str, Rank, Callable[[Any, Any], Any]]] = {
    ast.Lt: ("<", Rank.ORDER, operator.lt),
    ast.LtE: ("<=", Rank.ORDER, operator.le),
    ast.Gt: (">", Rank.ORDER, operator.gt),
    ast.GtE: (">=", Rank.ORDER, operator.ge),
    ast.Eq: ("==", Rank.EQUAL, operator.eq),
    ast.NotEq: ("!=", Rank.EQUAL, operator.ne),
}
# Functions of math.h by what Python calls; the type's suffix follows.
OF_MATH_H: dict[Any, str] = {
    elementary.fma: "fma",
    math.sqrt: "sqrt",
    math.copysign: "copysign",
    np.floor: "floor",
    builtins.abs: "fabs",
}
# Functions of templates/helpers.c, with the kind of their result.
HELPERS: dict[Any, tuple[str, str]] = {
    builtins.min: ("smaller", REAL),
    builtins.max: ("larger", REAL),
    np.sign: ("sign", REAL),
    elementary.bits_of_double: ("bits_of", BITS),
    elementary.double_of_bits: ("real_of", REAL),
}


class Operations:
    """Makes numbers from numbers, for one type of reals."""

    def __init__(self, precision: Precision) -> None:
        self.precision = precision

    def real(self, number: Number) -> Number:
        """The number as a real."""
        if number.kind == REAL:
            return number
        if number.kind != INTEGER:
            raise ExportError(f"{number.text} is no number")
        if number.value is not None and not number.text.isidentifier():
            value = float(number.value)
            return Number(REAL, self.precision.literal(value), Rank.UNARY, value)
        text = f"({self.precision.name}){number.within(Rank.UNARY)}"
        return Number(REAL, text, Rank.UNARY, None if number.value is None else float(number.value))

    def condition(self, number: Number) -> Number:
        """The number as the truth that ``if`` sees."""
        if number.kind == TRUTH:
            return number
        return self.compare(ast.NotEq, number, Number(INTEGER, "0", value=0))

    def alike(self, *numbers: Number) -> tuple[Number, ...]:
        """The numbers with the same kind."""
        if any(number.kind == REAL for number in numbers):
            return tuple(map(self.real, numbers))
        return numbers

    def binary(self, kind: type, left: Number, right: Number) -> Number:
        """A number from two by an operator."""
        if kind is ast.Mod and left.kind == right.kind == INTEGER:
            return Number(INTEGER, f"remainder_of({left.text}, {right.text})")
        if kind not in BINARY:
            raise ExportError(f"no operator {kind.__name__} in C")
        symbol, rank, function = BINARY[kind]
        if kind is ast.Div:
            left, right = self.real(left), self.real(right)
        left, right = self.alike(left, right)
        value = _known(function, left, right)
        bits = BITS in (left.kind, right.kind)
        if value is not None and left.kind == INTEGER and (left.text + right.text).isdigit():
            return Number(INTEGER, str(value), Rank.ATOM if value >= 0 else Rank.UNARY, value)
        # Compilers warn of bits that are mixed with other operators.
        tight = Rank.UNARY if rank < Rank.SUM else rank
        text = f"{left.within(tight)} {symbol} {right.within(Rank(max(tight, rank + 1)))}"
        return Number(BITS if bits else left.kind, text, rank, value)

    def negative(self, number: Number) -> Number:
        """The number with the other sign."""
        value = None if number.value is None else -number.value
        return Number(number.kind, f"-{number.within(Rank.ATOM)}", Rank.UNARY, value)

    def opposite(self, number: Number) -> Number:
        """Not the truth."""
        number = self.condition(number)
        if number.value is not None:
            return truth(not number.value)
        return Number(TRUTH, f"!{number.within(Rank.UNARY)}", Rank.UNARY)

    def compare(self, kind: type, left: Number, right: Number) -> Number:
        """The truth of a comparison."""
        symbol, rank, function = COMPARISON[kind]
        left, right = self.alike(left, right)
        value = _known(function, left, right)
        if value is not None:
            return truth(value)
        return Number(TRUTH, f"{left.within(Rank.SHIFT)} {symbol} {right.within(Rank.SHIFT)}", rank)

    def both(self, numbers: list[Number], any_of: bool) -> Number:
        """``and`` or ``or``; known ones that do not decide are left out."""
        kept: list[Number] = []
        for number in map(self.condition, numbers):
            if number.value is None or number.value == any_of:
                kept.append(number)
            if number.value == any_of and number.value is not None:
                break
        if not kept:
            return truth(not any_of)
        if len(kept) == 1:
            return kept[0]
        symbol, rank = (" || ", Rank.OR) if any_of else (" && ", Rank.AND)
        return Number(TRUTH, symbol.join(number.within(Rank.BIT_OR) for number in kept), rank)

    def choice(self, condition: Number, first: Number, second: Number) -> Number:
        """One of two numbers."""
        first, second = self.alike(first, second)
        text = (
            f"{condition.within(Rank.OR)} ? {first.within(Rank.OR)} : {second.within(Rank.CHOICE)}"
        )
        return Number(first.kind, text, Rank.CHOICE)

    def call(self, function: Any, numbers: list[Number]) -> Number | None:
        """The result of a function of C, or None if there is none for this one."""
        texts = ", ".join(self.real(n).text if n.kind == INTEGER else n.text for n in numbers)
        if function is builtins.float:
            return self.real(*numbers)
        if function in (math.isnan, np.isnan):
            return Number(TRUTH, f"isnan({texts})")
        if function in (math.floor, math.ceil):
            rounded = f"{function.__name__}{self.precision.suffix}({texts})"
            return Number(INTEGER, f"(int64_t){rounded}", Rank.UNARY)
        if function in OF_MATH_H:
            return Number(REAL, f"{OF_MATH_H[function]}{self.precision.suffix}({texts})")
        if function in HELPERS:
            name, kind = HELPERS[function]
            return Number(kind, f"{name}({texts})")
        return None


def _known(function: Callable[[Any, Any], Any], left: Number, right: Number) -> Any:
    if left.value is None or right.value is None:
        return None
    try:
        return function(left.value, right.value)
    except ArithmeticError:
        return None
