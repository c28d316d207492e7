"""Compiles the functions that run every sample, and caches the machine code.

Numba caches a compiled function by the content of *its own* file. After an edit of a function that
it calls from another file, the old machine code would stay in use. The folder of the cache is
therefore named by a hash of all sources of the function's package, and of the packages of furuta
that it imports.
"""

import glob
import hashlib
import inspect
import os
import re
import shutil
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache, partial
from importlib.util import find_spec
from itertools import takewhile
from multiprocessing import parent_process
from pathlib import Path
from time import monotonic
from typing import Any, TypeVar, cast

import numba
import numba.extending
import numpy as np
from numba.core.event import Event, Listener, register
from numba.core.runtime import rtsys

# Options of numba for the second dispatcher, which compiled callers use. It has no wrapper for
# Python or C and no file in the cache, which halves the time of compilation.
UNWRAPPED: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}

# Caches of a package that remain: those of its newest contents.
KEPT_CACHES = 4
_IMPORT = re.compile(rb"^\s*(?:from|import)\s+(furuta\w*)", re.MULTILINE)

NOTICE = "furuta: compiling; the first run takes up to a minute, later ones start at once"
# Time of compilation without a notice [s]: a few functions may be new after a change.
UNNOTICED = 2.0

# Numba adds its options when it is imported.
_config: Any = numba.config

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function, cached: bool = True, **options: Any) -> Function:
    """Compile ``function`` in nopython mode, cached beside its installed package.

    Fast-math is off, so the compiler does not reorder arithmetic and results are reproducible.
    ``options`` are those of numba. A closure cannot be cached; it is compiled into the cached
    functions that call it.
    """
    options = {"nogil": True, "error_model": "numpy", **options}
    previous = _config.CACHE_DIR
    _config.CACHE_DIR = str(_cache_folder(inspect.getfile(function)))
    try:
        dispatcher: Any = numba.njit(cache=cached, **options)(function)
    finally:
        _config.CACHE_DIR = previous
    dispatcher.is_announced = True
    if cached and not _config.DISABLE_JIT:
        dispatcher._cache.load_overload = partial(_machine_code_of, dispatcher._cache)
    if not _config.DISABLE_JIT:

        @cache  # made when a compiled function calls this one; loading machine code needs none
        def unwrapped() -> Any:
            made: Any = numba.njit(**UNWRAPPED, **options)(function)
            made.is_announced = True
            return made

        # numba 0.59 to 0.68 asks a dispatcher for these two when compiled code calls it.
        dispatcher.get_call_template = lambda *given: unwrapped().get_call_template(*given)
        dispatcher.get_overload = lambda *given: unwrapped().get_overload(*given)
    return cast(Function, dispatcher)


def _machine_code_of(functions: Any, signature: Any, target: Any) -> Any:
    """The machine code of a function in its cache; None if it must be compiled.

    Numba 0.59 to 0.68 first loads all that a compiler needs, for half a second. Machine code needs
    only the run-time library; whoever compiles loads the rest.
    """
    rtsys.initialize(target)
    with functions._guard_against_spurious_io_errors():
        return functions._load_overload(signature, target)


def inlined(function: Function, **options: Any) -> Function:
    """Compile ``function`` and inline it into its callers. It must not make an array.

    Use it for functions that are called every sample and take arrays. The caller owns the arrays
    for the whole call, so their references need not be counted. Counting would take a third of the
    time of the closed loop.
    """
    return compiled(function, forceinline=True, _nrt=False, **options)


# By function and the arguments' types.
_machine_code: dict[tuple[Any, ...], Any] = {}


def for_types_of(function: Function, *arguments: Any) -> Function:
    """The machine code of ``function`` for arguments of these types, to be called from Python.

    A compiled function looks at the types of its arguments at every call, which takes most of the
    time of a short one.
    """
    if _config.DISABLE_JIT:
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
    if _config.DISABLE_JIT and in_python is not None:
        return in_python
    return numba.extending.intrinsic(function)


@cache
def _cache_folder(file: str) -> Path:
    """Where the machine code of functions in ``file`` is, for the sources as they are now.

    It is beside the package or, where that is not writable, in the user's cache.
    """
    root = _root(file)
    if os.environ.get("NUMBA_CACHE_DIR"):
        base = Path(os.environ["NUMBA_CACHE_DIR"]) / "furuta"
    elif os.access(root, os.W_OK):
        base = root / "__pycache__" / "furuta"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "furuta"
    folder = base / f"{root.name}-{_digest(root)[:16]}"
    if not folder.exists():
        with suppress(OSError):  # another process may remove them too
            earlier = sorted(base.glob(f"{glob.escape(root.name)}-*"), key=os.path.getmtime)
            for old in earlier[: 1 - KEPT_CACHES]:
                shutil.rmtree(old, ignore_errors=True)
    return folder


def _root(file: str) -> Path:
    """The folder of the outermost package around a file, or that of a file in no package."""
    folders = Path(file).absolute().parents
    packages = [*takewhile(_is_package, folders)]
    return packages[-1] if packages else folders[0]


def _is_package(folder: Path) -> bool:
    return (folder / "__init__.py").exists()


@cache
def _digest(root: Path) -> str:
    """Hash of all sources below ``root``, and of the packages of furuta that they import.

    A folder that is no package may hold anything: only the files in itself count.
    """
    content = hashlib.sha256()
    imported: set[bytes] = set()
    for file in sorted(root.rglob("*.py") if _is_package(root) else root.glob("*.py")):
        source = file.read_bytes()
        content.update(f"{file.relative_to(root)} {len(source)} ".encode() + source)
        imported.update(_IMPORT.findall(source))
    for name in sorted(imported):
        spec = find_spec(name.decode())
        if spec and spec.origin and _root(spec.origin) != root:
            content.update(_digest(_root(spec.origin)).encode())
    return content.hexdigest()


class _Notice(Listener):
    """Prints one line when this process has compiled our functions for a while."""

    def __init__(self) -> None:
        self._begun: list[float] = []  # a function is compiled while the one that calls it is
        self._total = 0.0
        self._is_due = parent_process() is None  # workers do not print

    def on_start(self, event: Event) -> None:
        if not hasattr(event.data["dispatcher"], "is_announced"):
            return
        self._begun.append(monotonic())
        if self._is_due and self._total + monotonic() - self._begun[0] > UNNOTICED:
            self._is_due = False
            print(NOTICE, file=sys.stderr, flush=True)

    def on_end(self, event: Event) -> None:
        if not hasattr(event.data["dispatcher"], "is_announced"):
            return
        begun = self._begun.pop()
        if not self._begun:
            self._total += monotonic() - begun


register("numba:compile", _Notice())


@compiled
def _same(number: float) -> float:
    return number


def load_machinery() -> None:
    """Load what the first call of a compiled function needs.

    A node does so before others can see it, so that it answers soon after they can.
    """
    _same(0.0)
