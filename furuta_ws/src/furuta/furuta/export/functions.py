"""Translates compiled Python functions to C, with all functions that they call.

A function is translated once for each combination of known arguments: kinds of laws, records of
the design, functions. The rest are its parameters in C. What it takes from the subset of Python:
assignments, ``if``, ``for`` over a range, ``return``, and :mod:`furuta.export.expressions`.
"""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from collections import Counter
from typing import Any, NamedTuple

from furuta.export.constants import Constants
from furuta.export.expressions import Expressions
from furuta.export.text import KEPT, comment, filled, summary, wrapped
from furuta.export.values import (
    INTEGER,
    REAL,
    Array,
    ExportError,
    Group,
    Known,
    Memory,
    Number,
    Precision,
    Rank,
    Value,
    inner,
    leaves,
    rebuilt,
    usable,
)

INDENT = "    "


class CFunction(NamedTuple):
    """A translated function: its parameters by name, and its result.

    Without a ``name`` it does nothing but give its result.
    """

    name: str
    parameters: dict[str, Value]
    result: Any


class Translation:
    """All functions and memories that are translated together."""

    def __init__(
        self, precision: Precision, prefix: str, constants: Constants | None = None
    ) -> None:
        self.constants = constants or Constants(precision)
        self.precision = precision
        self.prefix = prefix
        self.used_fields: set[tuple[type, str]] = set()
        self.code: list[str] = []
        self._functions: dict[Any, CFunction] = {}

    def function(self, python: Any, arguments: dict[str, Value]) -> CFunction:
        """The C function for these arguments, by name."""
        key = (python, tuple(map(_shape, arguments.values())))
        if key not in self._functions:
            self._functions[key] = _Function(self, python, arguments).translate()
        return self._functions[key]

    def free_name(self, python: Any) -> str:
        """A name for a function that no other has."""
        name = f"{python.__module__.rpartition('.')[2]}_{python.__name__.strip('_<>')}"
        taken = [each.name for each in self._functions.values()]
        same = sum(re.fullmatch(rf"{name}(_\d+)?", each) is not None for each in taken)
        return f"{name}_{same + 1}" if same else name

    def structure_name(self, kind: type) -> str:
        """The name of the C structure for a memory."""
        return self.prefix + re.sub(r"(?<!^)(?=[A-Z])", "_", kind.__name__).lower()

    def helpers(self, code: str) -> list[str]:
        """The definitions of the helpers that some code uses."""
        given = filled("helpers.c", real=self.precision.name, bits=self.precision.bits)
        names = {text: text.partition("(")[0].split()[-1] for text in given.strip().split("\n\n")}
        return [text for text, name in names.items() if re.search(rf"\b{name}\(", code)]


class _Return(NamedTuple):
    indent: str
    value: Any


class _Function(Expressions):
    """The translation of one function."""

    def __init__(self, whole: Translation, python: Any, arguments: dict[str, Value]) -> None:
        super().__init__(python, whole.constants, whole.used_fields)
        self.whole = whole
        self.arguments = arguments
        (tree,) = ast.parse(textwrap.dedent(inspect.getsource(python))).body
        if not isinstance(tree, ast.FunctionDef):
            raise ExportError("it is no function with a name")
        self.tree = tree
        self.stored = Counter(
            node.id
            for node in ast.walk(tree)
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
        )
        self.kinds: dict[str, str] = {}  # of the local variables in C
        self.first: list[str] = []  # declarations at the beginning
        self.lines: list[str | _Return] = []
        self.indent = INDENT
        self.temporaries = 0
        self.parameters: dict[str, Value] = {}

    def translate(self) -> CFunction:
        """Translate it, and add its C to the whole."""
        for name, value in self.arguments.items():
            self.names[name] = self._parameter(name, value)
        self._block(self.tree.body)
        returns = [line.value for line in self.lines if isinstance(line, _Return)]
        result = _joined(returns)
        plain = len(self.lines) == len(returns) <= 1
        if plain and all(leaf.is_constant for leaf in inner(result)):
            return CFunction("", {}, result)
        name = self.whole.free_name(self.function)
        code = "\n".join([*self.first, *(_rendered(line, result, name) for line in self.lines)])
        words = set(re.findall(r"\w+", code))
        needed = {each: value for each, value in self.parameters.items() if each in words}
        done = CFunction(name, needed, result)
        self._write(done, code)
        return done

    def _parameter(self, name: str, value: Value) -> Value:
        """The value of a parameter inside; what is not known becomes a parameter in C."""
        if isinstance(value, Group):
            return rebuilt(value, (self._parameter(*leaf) for leaf in leaves(value, name)))
        if _is_specialised(value, name in self.arguments) and name not in self.stored:
            return value
        inside: Value = value
        if isinstance(value, Number):
            inside, self.kinds[name] = Number(value.kind, name), value.kind
        elif isinstance(value, Array):
            inside = value._replace(text=name)
        elif isinstance(value, Memory):
            inside = Memory(value.kind, name, f"{name}->")
        self.parameters[usable(name)] = inside
        return inside

    def call(self, function: Any, arguments: list[Value], named: dict[str, Value]) -> Any:
        """Call a function that is translated too."""
        python = getattr(function, "py_func", function)
        if not inspect.isfunction(python) or not python.__module__.startswith("furuta"):
            name = getattr(function, "__name__", repr(function))
            raise ExportError(f"{name} is no function that C has to the last bit")
        bound = inspect.signature(python).bind(*arguments, **named)
        done = self.whole.function(python, bound.arguments)
        if not done.name:
            return done.result
        given = dict(leaf for item in bound.arguments.items() for leaf in leaves(*item[::-1]))
        texts = ", ".join(given[name].text for name in done.parameters)
        return self._result(f"{done.name}({texts})", done)

    def _result(self, text: str, done: CFunction) -> Any:
        """The value of a call."""
        if done.result is None:
            self._emit(f"{text};")
            return None
        if isinstance(done.result, Number):
            return Number(done.result.kind, text)
        if self.conditional:
            raise ExportError(f"{done.name} is called in a conditional expression")
        self.temporaries += 1
        name = f"{done.name}_{self.temporaries}"
        self._emit(f"const {done.name}_result {name} = {text};")
        parts = (
            leaf if leaf.is_constant else Number(leaf.kind, f"{name}.{field}")
            for field, leaf in leaves(done.result, "")
        )
        return rebuilt(done.result, parts)

    def _block(self, statements: list[ast.stmt]) -> bool:
        """Translate statements; return whether they end with a return."""
        for statement in statements:
            try:
                if self._method(statement)(statement, statements):
                    return True
            except ExportError as error:
                raise self._located(error, statement) from None
        return False

    def _located(self, error: ExportError, statement: ast.stmt) -> ExportError:
        """The error with the place where it was found first."""
        if error.located:
            return error
        line = self.function.__code__.co_firstlineno + statement.lineno - 1
        where = f"{self.function.__module__}, line {line}, function {self.function.__name__}"
        return ExportError(f"{where} cannot be exported: {error}", located=True)

    def _emit(self, text: str) -> None:
        self.lines.append(self.indent + text)

    def _expr(self, node: ast.Expr, _: list[ast.stmt]) -> None:
        value = None if isinstance(node.value, ast.Constant) else self.value(node.value)
        if isinstance(value, Number) and value.text.endswith(")"):
            self._emit(f"{value.text};")

    def _continue(self, node: ast.Continue, _: list[ast.stmt]) -> bool:
        self._emit("continue;")
        return True

    def _break(self, node: ast.Break, _: list[ast.stmt]) -> bool:
        self._emit("break;")
        return True

    def _return(self, node: ast.Return, _: list[ast.stmt]) -> bool:
        value = self.value(node.value) if node.value else None
        self.lines.append(_Return(self.indent, value))
        return True

    def _assign(self, node: ast.Assign, block: list[ast.stmt]) -> None:
        value = self.value(node.value)
        for target in node.targets:
            self._store(target, value, block)
            if isinstance(value, Number) and value.value is None:
                value = self.number(target)  # evaluated once

    def _augassign(self, node: ast.AugAssign, block: list[ast.stmt]) -> None:
        old, change = self.number(node.target), self.number(node.value)
        self._store(node.target, self.operations.binary(type(node.op), old, change), block)

    def _store(self, target: ast.expr, value: Any, block: list[ast.stmt]) -> None:
        if isinstance(target, ast.Tuple):
            self._store_all(target.elts, value, block)
        elif isinstance(target, ast.Name):
            self._store_name(target.id, value, block)
        else:
            place = self.number(target)
            value = self.operations.real(value) if place.kind == REAL else value
            self._emit(f"{place.text} = {value.text};")

    def _store_all(self, targets: list[ast.expr], value: Any, block: list[ast.stmt]) -> None:
        """Assign in order; no value may depend on a place that is written before it is."""
        pairs = list(zip(targets, value.values, strict=True))
        for i, (target, _) in enumerate(pairs):
            place = target.id if isinstance(target, ast.Name) else self.number(target).text
            later = [getattr(each, "text", "") for _, each in pairs[i + 1 :]]
            if any(re.search(rf"(?<![\w>.]){re.escape(place)}(?![\w\[])", text) for text in later):
                raise ExportError(f"{place} is written and used in one assignment")
        for target, each in pairs:
            self._store(target, each, block)

    def _store_name(self, name: str, value: Any, block: list[ast.stmt]) -> None:
        if name == "_":
            return
        in_branch = name in self.names and self.indent != INDENT
        if in_branch and not isinstance(value, Number):
            raise ExportError(f"{name} is no number, and means something else in a branch")
        if isinstance(value, Group):
            parts = (self._kept(n, leaf, block) for n, leaf in leaves(value, name))
            self.names[name] = rebuilt(value, parts)
        elif (
            self.stored[name] == 1
            and not in_branch
            and (value.is_constant or not isinstance(value, Number))
        ):
            self.names[name] = value
        elif isinstance(value, Number):
            self.names[name] = self._variable(name, value, block)
        else:
            raise ExportError(f"{name} means several things")

    def _kept(self, name: str, leaf: Any, block: list[ast.stmt]) -> Any:
        """A number of a group, as it is now."""
        fixed = not isinstance(leaf, Number) or leaf.is_constant or leaf.text.isidentifier()
        return leaf if fixed else self._variable(name, leaf, block)

    def _variable(self, name: str, value: Number, block: list[ast.stmt]) -> Number:
        """Assign to a variable of C, which is declared where it is needed."""
        kind = self.kinds.setdefault(name, value.kind)
        value = self.operations.real(value) if kind == REAL else value
        if kind != value.kind:
            raise ExportError(f"{name} has values of several kinds")
        declaration = f"{self.whole.precision.type_of(kind)} {usable(name)}"
        if name in self.names:
            self._emit(f"{name} = {value.text};")
        elif self._is_local(name, block):
            self._emit(f"{declaration} = {value.text};")
        else:
            self.first.append(f"{INDENT}{declaration};")
            self._emit(f"{name} = {value.text};")
        return Number(kind, name)

    def _is_local(self, name: str, block: list[ast.stmt]) -> bool:
        """Whether a name occurs nowhere but in these statements."""
        inside = sum(_occurrences(statement, name) for statement in block)
        return self.indent == INDENT or inside == _occurrences(self.tree, name)

    def _if(self, node: ast.If, _: list[ast.stmt]) -> bool:
        condition = self.condition(node.test)
        if condition.value is not None:
            return self._block(node.body if condition.value else node.orelse)
        body, ends = self._indented(node.body)
        other, other_ends = self._indented(node.orelse)
        self._emit(f"if ({condition.text}) {{")
        self.lines += body
        if other:
            self._emit("} else {")
            self.lines += other
        self._emit("}")
        return ends and other_ends

    def _indented(self, statements: list[ast.stmt]) -> tuple[list[str | _Return], bool]:
        """The lines of a block, and whether it ends with a return."""
        outer, self.lines, self.indent = self.lines, [], self.indent + INDENT
        ends, lines = self._block(statements), self.lines
        self.lines, self.indent = outer, self.indent[: -len(INDENT)]
        return lines, ends

    def _for(self, node: ast.For, _: list[ast.stmt]) -> None:
        if not isinstance(node.iter, ast.Call) or not isinstance(node.target, ast.Name):
            raise ExportError("for runs over a range only")
        if len(node.iter.args) > 2:
            raise ExportError("range has a step")
        *start, end = map(self.number, node.iter.args)
        if not start and end.value == 0:
            return
        i = node.target.id if node.target.id != "_" else "turn"
        self.names[node.target.id], self.kinds[i] = Number(INTEGER, i), INTEGER
        first = start[0].text if start else "0"
        body, _ends = self._indented(node.body)
        self._emit(f"for (int64_t {i} = {first}; {i} < {end.within(Rank.ATOM)}; {i}++) {{")
        self.lines += body
        self._emit("}")

    def _while(self, node: ast.While, _: list[ast.stmt]) -> None:
        """A loop; its condition must be an expression of C."""
        condition = self._perhaps(node.test, self.condition)
        body, _ends = self._indented(node.body)
        self._emit(f"while ({condition.text}) {{")
        self.lines += body
        self._emit("}")

    def _write(self, done: CFunction, code: str) -> None:
        """Add the C function with its comment."""
        name, parameters, result = done
        of = self.whole.precision.type_of
        declared = ", ".join(map(self._declaration, parameters.items())) or "void"
        returned = "void"
        if isinstance(result, Number):
            returned = of(result.kind)
        elif result is not None:
            returned = f"{name}_result"
            fields = [
                f"{INDENT}{of(leaf.kind)} {field};"
                for field, leaf in leaves(result, "")
                if not leaf.is_constant
            ]
            self.whole.code.append("\n".join(["typedef struct {", *fields, f"}} {returned};"]))
        about = summary(self.function)
        where = f"{self.function.__module__}.{self.function.__name__}"
        head = wrapped(f"static {returned} {name}({declared}){KEPT}{{")
        remark = comment(f"{about} ({where})" if about else where)
        self.whole.code.append(f"{remark}\n{head}\n{code}\n}}")

    def _declaration(self, parameter: tuple[str, Any]) -> str:
        name, value = parameter
        if isinstance(value, Memory):
            return f"{self.whole.structure_name(value.kind)}{KEPT}*{name}"
        star = "*" if isinstance(value, Array) else ""
        return f"{self.whole.precision.type_of(value.kind)}{KEPT}{star}{name}"


def _rendered(line: str | _Return, result: Any, name: str) -> str:
    """A line of C; what a return gives of a known result is left out."""
    if isinstance(line, str):
        return wrapped(line)
    pairs = zip(inner(line.value), inner(result), strict=True)
    given = ", ".join(leaf.text for leaf, whole in pairs if not whole.is_constant)
    if isinstance(result, Group):
        given = f"({name}_result){{{given}}}"
    if isinstance(result, Number):
        given = line.value.text
    return wrapped(f"{line.indent}return {given};".replace(" ;", ";"))


def _occurrences(node: ast.AST, name: str) -> int:
    return sum(isinstance(each, ast.Name) and each.id == name for each in ast.walk(node))


def _is_specialised(value: Value, alone: bool) -> bool:
    """Whether a function is translated for this value; reals are parameters unless in a group."""
    real = isinstance(value, Number) and value.kind == REAL
    return not isinstance(value, Group) and value.is_constant and not (alone and real)


def _shape(value: Any, alone: bool = True) -> Any:
    """What the translation of a function depends on."""
    if isinstance(value, Group):
        return value.kind, tuple(_shape(leaf, alone=False) for leaf in inner(value))
    if isinstance(value, Known):
        return (value.path, *_whole_numbers(value.value)) if value.path else id(value.value)
    return value if _is_specialised(value, alone) else (type(value), value.kind)


def _whole_numbers(record: Any) -> list[int]:
    """All integers in a record of the design: they select what is generated."""
    if isinstance(record, tuple):
        return [number for each in record for number in _whole_numbers(each)]
    return [record] if isinstance(record, int) else []


def _joined(returns: list[Any]) -> Any:
    """The result of a function; a number in it is known if there is one return only."""
    if len(returns) < 2:
        return returns[0] if returns else None
    parts = (leaf._replace(value=None, rank=Rank.CHOICE) for leaf in inner(returns[0]))
    return rebuilt(returns[0], parts)
