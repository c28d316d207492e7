"""Functions of the user's own as parts of a loop: compiled, called by address.

A part is a Python function, or a friction law with such functions; parameters choose it by
a name that the process accepts (:mod:`furuta_model.accepted_parts`). The loop is compiled once for
all such parts, because it calls them by their addresses, which are numbers of its design. So
built-in parts are unaffected.

The first argument of a function with memory is a record of the fields of a dataclass, if it is
annotated with one, or else an array of :data:`OWN_NUMBERS` numbers. All numbers start at zero.
"""

import logging
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from inspect import isfunction
from pathlib import Path
from time import monotonic
from traceback import extract_tb
from typing import Any, get_type_hints

import numba
import numpy as np
from numba import types
from numba.core import cgutils

from furuta_model.accepted_parts import accepted_part
from furuta_model.block import block, zeros
from furuta_model.compiled import UNWRAPPED, inlined, make_intrinsic
from furuta_model.parameters import ParameterError
from furuta_model.state import SIGNALS

# Numbers that the memory of an own function holds.
OWN_NUMBERS = 32
# Numba's type of an array that an own function gets.
ADDRESS = types.CPointer(types.float64)
_LOCATION = re.compile(r'File "(.+?)", line (\d+)')
# What the user's mistake is where numba's words are about its own workings.
_MISTAKES = {
    r"No conversion from none to float64": "it must return a number, and returns nothing",
    r"No conversion from (.+?) to float64": r"it must return a number, and returns \1",
    r"Signature mismatch: (\d+) .* function takes (\d+).*": (
        r"it takes \2 arguments, and is called with \1"
    ),
    r"Cannot bind .* to signature '\((.*)\)' due to .*(many|missing).*": (
        r"it is called with other arguments than (\1)"
    ),
}

# Shortest time between two reports of one error [s].
REPORT_PERIOD = 1.0
_LOG = logging.getLogger(__name__)


@dataclass
class OwnMemory:
    """Address of the own function that has run last, and what it remembers."""

    function: int = 0
    numbers: np.ndarray = zeros(OWN_NUMBERS)


def own_function(name: str) -> Callable[..., Any]:
    """The accepted function with this name.

    Raises:
        ParameterError: The name is not accepted, or is that of something else.
    """
    part: Callable[..., Any] = accepted_part(name)
    if not isfunction(getattr(part, "py_func", part)):
        raise ParameterError(f"{name} must be a Python function, given {type(part).__name__}")
    return part


@cache
def address_of(
    function: Callable[..., Any], *arguments: Any, entry: Callable[..., Any] | None = None
) -> int:
    """Address of an own function as code with numba's types ``arguments``, which gives a float64.

    ``entry`` makes the code from the compiled function, by default the function itself.

    Raises:
        ParameterError: The function cannot be compiled; the message names its line.
    """
    inner: Any = function
    if not hasattr(function, "py_func"):
        inner = numba.njit(error_model="numpy", **UNWRAPPED)(function)
    if not isinstance(sys.unraisablehook, _Report):
        sys.unraisablehook = _Report()
    try:
        code = numba.cfunc(types.float64(*arguments), error_model="numpy")(
            entry(inner) if entry else inner.py_func
        )
    except Exception as error:  # numba raises many kinds
        raise ParameterError(_one_line(function, str(error))) from None
    returned = [each.signature.return_type for each in inner.overloads.values()]
    if any(isinstance(each, types.Optional) for each in returned):
        raise ParameterError(_one_line(function, "it returns a number in some branches only"))
    _code.append(code)
    address: Any = code.address
    return int(address)


_code: list[Any] = []


@cache
def sample_function(function: Callable[..., Any], given: type, *others: Any) -> int:
    """Address of an own function (memory, x, *others, p) that runs every sample.

    It gives a number, or changes x if ``others`` (numba's types) has an array; its code then gives
    1. After an exception the code gives 0. Arrays have :data:`SIGNALS` numbers; p is a ``given``.
    """
    memory = _memory_view(function)

    def entry(inner: Any) -> Callable[..., float]:
        def update(own: Any, x: Any, measurement: Any, p: Any) -> float:
            inner(memory(own), _signals(x), _signals(measurement), p)
            return 1.0

        if ADDRESS in others:
            return update
        if others:
            return lambda own, x, number, p: inner(memory(own), _signals(x), number, p)
        return lambda own, x, p: inner(memory(own), _signals(x), p)

    return address_of(function, types.voidptr, ADDRESS, *others, numba.typeof(given()), entry=entry)


def kind_and_address(name: str, names: Sequence[str], given: type, *others: Any) -> tuple[int, int]:
    """Kind of a part, its place in ``names``, and 0; of an own function the next and its address.

    ``given`` and ``others`` are those of :func:`sample_function`.
    """
    if name in names:
        return names.index(name), 0
    return len(names), sample_function(own_function(name), given, *others)


def _memory_view(function: Callable[..., Any]) -> Any:
    """A compiled function that makes the memory of an own function from its address."""
    plain = getattr(function, "py_func", function)
    try:
        hints = get_type_hints(plain)
    except Exception as error:  # of whatever the annotations evaluate
        raise ParameterError(_one_line(function, f"its annotations: {error}")) from None
    first: Any = next((hints.get(name) for name in plain.__code__.co_varnames[:1]), None)
    return _view_of(first) if hasattr(first, "__dataclass_fields__") else _numbers


# For all functions: numba never frees machine code.
_signals = numba.njit(lambda address: numba.carray(address, SIGNALS), **UNWRAPPED)
_numbers = numba.njit(lambda address: numba.carray(address, OWN_NUMBERS, np.float64), **UNWRAPPED)


@cache
def _view_of(first: Any) -> Any:
    """The same for a memory with the fields of a dataclass."""
    initial = block(first())
    kind = initial.dtype
    if kind.itemsize > 8 * OWN_NUMBERS or any(initial.tobytes()):
        raise ParameterError(
            f"memory {first.__name__} must start at zero and have at most {OWN_NUMBERS} numbers"
        )
    return numba.njit(lambda address: numba.carray(address, 1, kind)[0], **UNWRAPPED)


class _Report:
    """Python's hook for exceptions that cannot be raised: one line for those of own functions.

    numba gives it what compiled code cannot raise to its caller; the function gives 0 then.
    """

    def __init__(self) -> None:
        self._earlier = sys.unraisablehook
        self._reported_at: dict[tuple[str, int | None], float] = {}

    def __call__(self, unraisable: "sys.UnraisableHookArgs") -> None:
        places = extract_tb(unraisable.exc_traceback)
        if "numba" not in str(unraisable.object) or not places:
            self._earlier(unraisable)
            return
        file, line, name, _ = places[-1]
        now = monotonic()
        if now - self._reported_at.get((file, line), -REPORT_PERIOD) >= REPORT_PERIOD:
            self._reported_at[file, line] = now
            reason = f"{unraisable.exc_type.__name__}: {unraisable.exc_value}"
            _LOG.error("%s failed and gave 0 (%s, line %s): %s", name, file, line, reason)


def _one_line(function: Callable[..., Any], message: str) -> str:
    """Numba's message as one line, with the innermost file and line that it names."""
    plain = getattr(function, "py_func", function)
    own = Path(__file__).resolve()
    places = [place for place in _LOCATION.findall(message) if Path(place[0]).resolve() != own]
    code = plain.__code__
    file, line = places[-1] if places else (code.co_filename, code.co_firstlineno)
    lines = [text.strip() for text in re.sub(r"\x1b\[\d*m", "", message).splitlines()]
    reason = next((text for text in lines if text and not text.startswith("Failed in")), message)
    for words, mistake in _MISTAKES.items():
        if found := re.match(words, reason):
            reason = found.expand(mistake)
    return (
        f"{plain.__qualname__} cannot be compiled ({Path(file).resolve()}, line {line}): {reason}"
    )


def _calling(_: Any, address: Any, arguments: Any) -> Any:
    """Call an own function: arrays by the addresses of their numbers, all else as it is."""

    def generate(context: Any, builder: Any, sig: Any, values: Any) -> Any:
        ir: Any = cgutils.ir
        given = [
            context.make_array(kind)(context, builder, value).data
            if isinstance(kind, types.Array)
            else value
            for kind, value in zip(arguments, cgutils.unpack_tuple(builder, values[1]), strict=True)
        ]
        code = ir.FunctionType(ir.DoubleType(), [value.type for value in given])
        call = builder.call(builder.inttoptr(values[0], code.as_pointer()), given)
        # The code around it is optimised for built-in parts. (A name unknown to llvmlite.)
        set.add(call.attributes, "cold")
        return call

    return types.float64(types.intp, arguments), generate


call_own: Callable[[int, tuple[Any, ...]], float] = make_intrinsic(_calling)


@inlined
def begin_own(memory: OwnMemory, function: int) -> None:
    """Prepare the memory of an own function: zeros, if another one has run before."""
    if memory.function != function:
        memory.function = function
        for i in range(OWN_NUMBERS):
            memory.numbers[i] = 0.0


@inlined
def forget_own(memory: OwnMemory) -> None:
    """Let the own function start anew."""
    memory.function = 0
