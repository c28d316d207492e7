"""Translates expressions of compiled Python functions to C."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Callable
from typing import Any, get_type_hints

import numpy as np

from furuta.export.constants import Constants
from furuta.export.operations import Operations
from furuta.export.values import (
    KINDS,
    REAL,
    Array,
    ExportError,
    Group,
    Known,
    Memory,
    Number,
    Value,
)


class Expressions:
    """The expressions of one function, with the values of its local names."""

    def __init__(self, function: Any, constants: Constants, used: set[tuple[type, str]]) -> None:
        self.function = function
        self.constants = constants
        self.operations = Operations(constants.precision)
        self.names: dict[str, Value] = {}
        self.used = used  # fields of memories
        self.conditional = False

    def call(self, function: Any, arguments: list[Value], named: dict[str, Value]) -> Any:
        """Call a function that is translated too."""
        raise NotImplementedError

    def value(self, node: ast.expr) -> Any:
        """The value of any expression."""
        return self._method(node)(node)

    def _method(self, node: ast.AST) -> Callable[..., Any]:
        """What translates nodes of this type."""
        method = getattr(self, f"_{type(node).__name__.lower()}", None)
        if method is None:
            raise ExportError(f"no {type(node).__name__} in C")
        return method  # type: ignore[no-any-return]

    def number(self, node: ast.expr) -> Number:
        """The value of an expression that is a number."""
        value = self.value(node)
        if not isinstance(value, Number):
            raise ExportError(f"{ast.unparse(node)} is no number")
        return value

    def condition(self, node: ast.expr) -> Number:
        """The truth of an expression."""
        return self.operations.condition(self.number(node))

    def _constant(self, node: ast.Constant) -> Value:
        return self.constants.value(node.value, "", type(node.value))

    def _name(self, node: ast.Name) -> Value:
        name, function = node.id, self.function
        if name in self.names:
            return self.names[name]
        if name in function.__code__.co_freevars:
            cell = function.__closure__[function.__code__.co_freevars.index(name)]
            return Known(cell.cell_contents)
        if name in function.__globals__:
            return self.constants.global_value(
                name, function.__globals__[name], function.__module__
            )
        return Known(getattr(builtins, name))

    def _attribute(self, node: ast.Attribute) -> Value:
        base = self.value(node.value)
        if isinstance(base, Memory):
            return self.field(base, node.attr)
        if isinstance(base, Group):
            found: Value = base.values[base.names.index(node.attr)]
            return found
        if isinstance(base, Array) and node.attr == "shape":
            return Known(base.shape)
        if not isinstance(base, Known):
            raise ExportError(f"no attribute {node.attr} in C")
        if base.path:
            return self.constants.field(base, node.attr)
        value = getattr(base.value, node.attr)
        return self.constants.value(value, "", type(value))

    def field(self, memory: Memory, name: str) -> Value:
        """A field of a memory."""
        self.used.add((memory.kind, name))
        kind, path = get_type_hints(memory.kind)[name], memory.fields + name
        if kind is np.ndarray:
            return Array(REAL, path)
        if kind in KINDS:
            return Number(KINDS[kind], path)
        return Memory(kind, f"&{path}", f"{path}.")

    def _subscript(self, node: ast.Subscript) -> Value:
        base, index = self.value(node.value), self.value(node.slice)
        indices = index.values if isinstance(index, Group) else (index,)
        if isinstance(base, Known):
            value = base.value[indices[0].value]
            return self.constants.value(value, "", type(value))
        if isinstance(base, Group):
            found: Value = base.values[indices[0].value]
            return found
        return Number(base.kind, base.text + "".join(f"[{i.text}]" for i in indices))

    def _binop(self, node: ast.BinOp) -> Value:
        left, right = self.number(node.left), self.number(node.right)
        return self.operations.binary(type(node.op), left, right)

    def _unaryop(self, node: ast.UnaryOp) -> Value:
        number = self.number(node.operand)
        negates = isinstance(node.op, ast.USub)
        return (self.operations.negative if negates else self.operations.opposite)(number)

    def _compare(self, node: ast.Compare) -> Value:
        numbers = list(map(self.number, (node.left, *node.comparators)))
        pairs = zip(node.ops, numbers, numbers[1:], strict=False)
        return self.operations.both(
            [self.operations.compare(type(op), left, right) for op, left, right in pairs], False
        )

    def _boolop(self, node: ast.BoolOp) -> Value:
        first, *others = node.values
        numbers = [self.condition(first)]
        any_of = isinstance(node.op, ast.Or)
        for other in others:
            if numbers[-1].value is not None and numbers[-1].value == any_of:
                break
            numbers.append(self._perhaps(other, self.condition))
        return self.operations.both(numbers, any_of)

    def _ifexp(self, node: ast.IfExp) -> Value:
        condition = self.condition(node.test)
        if condition.value is not None:
            return self.value(node.body if condition.value else node.orelse)
        first, second = (self._perhaps(each, self.value) for each in (node.body, node.orelse))
        if not isinstance(first, Group):
            return self.operations.choice(condition, first, second)
        pairs = zip(first.values, second.values, strict=True)
        return Group(tuple(self.operations.choice(condition, *pair) for pair in pairs))

    def _perhaps(self, node: ast.expr, evaluate: Callable[[ast.expr], Any]) -> Any:
        """A part that is evaluated only under a condition: it must be an expression of C."""
        before, self.conditional = self.conditional, True
        try:
            return evaluate(node)
        finally:
            self.conditional = before

    def _tuple(self, node: ast.Tuple) -> Value:
        return Group(tuple(map(self.value, node.elts)))

    def _call(self, node: ast.Call) -> Value | None:
        callee = self.value(node.func)
        arguments = [self.value(each) for each in node.args]
        named = {each.arg: self.value(each.value) for each in node.keywords if each.arg}
        if not isinstance(callee, Known):
            raise ExportError(f"{ast.unparse(node.func)} is no function")
        if isinstance(callee.value, type) and hasattr(callee.value, "_fields"):
            return self._group(callee.value, arguments, named)
        if all(isinstance(each, Number) for each in arguments):
            result = self.operations.call(callee.value, arguments)  # type: ignore[arg-type]
            if result is not None:
                return result
        return self.call(callee.value, arguments, named)

    def _group(self, kind: Any, arguments: list[Value], named: dict[str, Value]) -> Group:
        """A named tuple; its reals are reals even if they are given as integers."""
        given = dict(zip(kind._fields, arguments, strict=False)) | named
        real = [name for name, hint in get_type_hints(kind).items() if hint is float]
        for name in real:
            given[name] = self.operations.real(given[name])  # type: ignore[arg-type]
        return Group(tuple(given[name] for name in kind._fields), kind)
