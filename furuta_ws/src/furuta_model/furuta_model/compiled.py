"""Compiles the functions that run every sample, and caches the machine code.

Numba caches a compiled function by the content of *its own* file. After an edit of a function that
it calls from another file, the old machine code would stay in use. The cache key here covers
everything that a function was compiled from.
"""

import hashlib
import inspect
import os
import re
from collections.abc import Callable, Sequence
from dataclasses import is_dataclass
from enum import Enum
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any, TypeVar, cast, get_type_hints

import numba
import numba.extending
import numpy as np

from furuta_model.compilation_notice import announce_compilation

# Options of numba for what compiled code calls, whose code is part of the caller's. Wrappers for
# Python and C and a file in the cache would be for nobody, and take half of the compilation.
UNWRAPPED: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}

# Modules in a name, as in package.module.NUMBER, in which the used values are looked for.
DEEPEST_MODULE = 3

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function, cached: bool = True, **options: Any) -> Function:
    """Compile ``function`` in nopython mode, cached beside its installed source.

    Fast-math is off, so the compiler does not reorder arithmetic and results are reproducible.
    ``options`` are those of numba. A closure cannot be cached; it is compiled into the cached
    functions that call it.
    """
    digest = _digest(function)
    options = {"nogil": True, "error_model": "numpy", **options}
    config: Any = numba.config
    previous = config.CACHE_DIR
    config.CACHE_DIR = str(_cache_directory(inspect.getfile(function)) / digest[:16])
    try:
        dispatcher: Any = numba.njit(cache=cached, **options)(function)
    finally:
        config.CACHE_DIR = previous
    dispatcher.furuta_digest = digest
    if not config.DISABLE_JIT:
        unwrapped: Any = numba.njit(**UNWRAPPED, **options)(function)
        unwrapped.furuta_digest = digest
        # What compiled code calls.
        dispatcher.get_call_template = unwrapped.get_call_template
        dispatcher.get_overload = unwrapped.get_overload
    return cast(Function, dispatcher)


def by_kind(functions: Sequence[Function]) -> Callable[..., Any]:
    """Return a compiled function ``f(kind, *arguments)`` that calls ``functions[kind]``.

    All functions take and return the same types: numbers and named tuples of numbers. The returned
    function has them as ``furuta_choices``.
    """
    # Written out, because compiled code cannot index functions. One calling the next would compile
    # the last of them as often as there are functions.
    names = {f"function_{kind}": each for kind, each in enumerate(functions)}
    *choices, last = (f"return {name}(*arguments)" for name in names)
    lines = [f"    if kind == {kind}: {choice}" for kind, choice in enumerate(choices)]
    source = "\n".join(["def dispatch(kind, *arguments):", *lines, f"    {last}"])
    exec(compile(source, __file__, "exec"), names)
    dispatcher: Any = inlined(names["dispatch"], cached=False)
    dispatcher.furuta_choices = tuple(functions)
    return cast(Callable[..., Any], dispatcher)


def inlined(function: Function, **options: Any) -> Function:
    """Compile ``function`` and inline it into its callers. It must not make an array.

    Use it for functions that are called every sample and take arrays. The caller owns the arrays
    for the whole call, so their references need not be counted. Counting would take a third of the
    time of the closed loop.
    """
    return compiled(function, forceinline=True, _nrt=False, **options)


announce_compilation()

# By function and the arguments' types.
_machine_code: dict[tuple[Any, ...], Any] = {}


def for_types_of(function: Function, *arguments: Any) -> Function:
    """The machine code of ``function`` for arguments of these types, to be called from Python.

    A compiled function looks at the types of its arguments at every call, which takes most of the
    time of a short one.
    """
    config: Any = numba.config
    if config.DISABLE_JIT:
        return function
    # Looking at a record's type takes milliseconds, and nodes ask at every change of a parameter.
    key = (function, *map(_kind, arguments))
    if key not in _machine_code:
        dispatcher: Any = function
        types = tuple(map(numba.typeof, arguments))
        _machine_code[key] = dispatcher.compile(types)
    return cast(Function, _machine_code[key])


def _kind(argument: Any) -> Any:
    """What determines numba's type of an argument."""
    if isinstance(argument, np.ndarray):
        return argument.dtype, argument.ndim, argument.flags.num
    if isinstance(argument, tuple):
        return type(argument), *map(_kind, argument)
    return getattr(argument, "dtype", type(argument))


def make_intrinsic(
    function: Callable[..., Any], in_python: Callable[..., Any] | None = None
) -> Any:
    """Make a function that compiled code calls, from one that generates its instructions.

    ``in_python`` does the same if compilation is switched off (NUMBA_DISABLE_JIT). Numba's
    declarations describe an intrinsic as it is written, not as it is called.
    """
    config: Any = numba.config
    if config.DISABLE_JIT and in_python is not None:
        return in_python
    made: Any = numba.extending.intrinsic(function)
    made.furuta_digest = _digest(function)
    return made


def _digest(function: Callable[..., Any]) -> str:
    """Hash of this file, the function's file, and what the machine code depends on elsewhere.

    That is what the function reaches through its globals, through modules among them, and through
    its closure: compiled functions that it calls, values that it uses, and named tuples and
    memories that it makes or takes.
    """
    content = hashlib.sha256(_file_digest(__file__).encode())
    content.update(_file_digest(inspect.getfile(function)).encode())
    names = sorted({*function.__code__.co_names, *_annotated(function)})
    _add_names(content, names, function.__globals__)
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        _add(content, name, cell.cell_contents)
    return content.hexdigest()


def _add_names(content: Any, names: list[str], space: dict[str, Any], depth: int = 0) -> None:
    """Add what has one of these names, here or in a module that has one."""
    for name in names:
        used = space.get(name)
        if not isinstance(used, ModuleType):
            _add(content, name, used)
        elif depth < DEEPEST_MODULE:
            _add_names(content, names, vars(used), depth + 1)


def _add(content: Any, name: str, used: Any) -> None:
    if hasattr(used, "furuta_digest"):
        content.update(used.furuta_digest.encode())
    elif isinstance(used, (bool, int, float, complex, str, bytes, np.dtype, Enum)):
        content.update(f"{name}={used!r}".encode())
    elif isinstance(used, (np.ndarray, np.generic)):
        content.update(f"{name}={used.dtype}{used.shape}".encode() + used.tobytes())
    elif isinstance(used, tuple):
        content.update(f"{name}={type(used).__name__} of {len(used)}".encode())
        for each in used:
            _add(content, "", each)
    elif isinstance(used, type) and (
        hasattr(used, "_fields") or is_dataclass(used) or issubclass(used, Enum)
    ):
        content.update(_file_digest(inspect.getfile(used)).encode())
        for field, kind in sorted(get_type_hints(used).items()):
            _add(content, field, kind)


def _annotated(function: Callable[..., Any]) -> set[str]:
    """Names in the annotations of the function."""
    return {
        name for text in function.__annotations__.values() for name in re.findall(r"\w+", str(text))
    }


@cache
def _file_digest(path: str) -> str:
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


@cache
def _cache_directory(source: str) -> Path:
    """``__pycache__`` beside the source, or the user's cache if that is not writable."""
    if os.environ.get("NUMBA_CACHE_DIR"):
        return Path(os.environ["NUMBA_CACHE_DIR"])
    if os.access(Path(source).parent, os.W_OK):
        return Path(source).parent / "__pycache__"
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "furuta"


@compiled
def _same(number: float) -> float:
    return number


def load_machinery() -> None:
    """Load what the first call of a compiled function needs, which takes up to a second.

    A node does so before others can see it, so that it answers soon after they can.
    """
    _same(0.0)
