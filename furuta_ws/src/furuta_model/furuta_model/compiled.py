"""Compilation of the functions that run every sample.

Numba caches a compiled function by the content of *its own* file, so editing a function
that it calls elsewhere would leave the old machine code in use. The cache here is keyed on
everything a function was compiled from.
"""

from __future__ import annotations

import hashlib
import inspect
import os
import re
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any, TypeVar, cast, get_type_hints

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function, cached: bool = True, **options: Any) -> Function:
    """Compile ``function`` in nopython mode, cached beside its installed source.

    No fast-math: results do not depend on the compiler's freedom to reorder. ``options`` are
    those of numba. A function made by another function (a closure) cannot be cached; it is
    compiled into the cached functions that call it.
    """
    digest = _digest(function)
    cache = _cache_directory(inspect.getfile(function)) / digest[:16]
    config: Any = numba.config
    before = config.CACHE_DIR
    config.CACHE_DIR = str(cache)
    try:
        dispatcher: Any = numba.njit(cache=cached, nogil=True, error_model="numpy", **options)(
            function
        )
    finally:
        config.CACHE_DIR = before
    dispatcher.furuta_digest = digest
    return cast(Function, dispatcher)


def by_kind(functions: Sequence[Function]) -> Callable[..., Any]:
    """One compiled function ``f(kind, *arguments)`` that calls ``functions[kind]``.

    The functions take and return the same types, numbers and named tuples of numbers.
    """
    first, *others = functions
    if not others:
        return compiled(lambda kind, *arguments: first(*arguments), cached=False)
    rest = by_kind(others)

    def choose(kind: int, *arguments: Any) -> Any:
        if kind == 0:
            return first(*arguments)
        return rest(kind - 1, *arguments)

    return compiled(choose, cached=False)


def inlined(function: Function, **options: Any) -> Function:
    """Compile ``function``, which makes no array, into those that call it.

    For what is called every sample and hands arrays on. Their owner outlives the call, so their
    references need not be counted: counting takes a third of the whole loop's time.
    """
    return compiled(function, forceinline=True, _nrt=False, **options)


def _digest(function: Callable[..., Any]) -> str:
    """Hash of this file, the function's, and all that its machine code depends on elsewhere.

    That is, through its globals, the modules among them, and its closure: compiled functions
    that it calls, numbers that it uses, and the named tuples that it makes or takes.
    """
    content = hashlib.sha256(_file_digest(__file__).encode())
    content.update(_file_digest(inspect.getfile(function)).encode())
    names = sorted({*function.__code__.co_names, *_annotated(function)})
    for name in names:
        used = function.__globals__.get(name)
        if isinstance(used, ModuleType):
            for inner in names:
                _add(content, inner, getattr(used, inner, None))
        else:
            _add(content, name, used)
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        _add(content, name, cell.cell_contents)
    return content.hexdigest()


def _add(content: Any, name: str, used: Any) -> None:
    if hasattr(used, "furuta_digest"):
        content.update(used.furuta_digest.encode())
    elif isinstance(used, (bool, int, float)):
        content.update(f"{name}={used!r}".encode())
    elif isinstance(used, type) and hasattr(used, "_fields"):
        content.update(_file_digest(inspect.getfile(used)).encode())
        for field, kind in sorted(get_type_hints(used).items()):
            _add(content, field, kind)


def _annotated(function: Callable[..., Any]) -> set[str]:
    """Names in the function's annotations, which are text here."""
    return {
        name for text in function.__annotations__.values() for name in re.findall(r"\w+", str(text))
    }


@cache
def _file_digest(path: str) -> str:
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


@cache
def _cache_directory(source: str) -> Path:
    """``__pycache__`` beside the source or, where that cannot be written, the user's cache."""
    if os.environ.get("NUMBA_CACHE_DIR"):
        return Path(os.environ["NUMBA_CACHE_DIR"])
    if os.access(Path(source).parent, os.W_OK):
        return Path(source).parent / "__pycache__"
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "furuta"
