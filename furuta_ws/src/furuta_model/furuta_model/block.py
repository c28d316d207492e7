"""Packs parameters or a memory into one block, which compiled code reads and writes by name.

Parameters are named tuples, a memory is a dataclass; both hold numbers, arrays and groups of their
own kind. In compiled code ``block[0]`` has their fields. A call from Python unpacks a named tuple
field by field, which takes a microsecond for every ten fields, more than the arithmetic of the
sample. A block is passed as one argument.
"""

from dataclasses import field, fields, is_dataclass
from functools import cache, partial
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import numba
import numpy as np


def block(group: Any) -> np.ndarray:
    """Pack a named tuple or a memory into a structured array (1,)."""
    packed = records(_layout(group))
    packed[0] = _content(group)
    return packed


def records(layout: np.dtype) -> np.ndarray:
    """Zeros of a structured type (1,), whose fields are attributes of ``[0]`` in compiled code."""
    config: Any = numba.config
    # Without compilation only a record array has its fields as attributes.
    return np.zeros(1, layout).view(np.recarray if config.DISABLE_JIT else np.ndarray)


def new_memory(kind: Any) -> np.ndarray:
    """A memory of this kind (a dataclass) as a structured array (1,), with its initial values."""
    return _initial_memory(kind).copy()


@cache
def _initial_memory(kind: Any) -> np.ndarray:
    return block(kind())


def zeros(*shape: int) -> Any:
    """Declare an array of zeros as a field of a memory."""
    return field(default_factory=partial(np.zeros, shape))


def field_names(value: Any) -> tuple[str, ...] | None:
    """Names of the fields of a named tuple or a memory; None for anything else."""
    kind: Any = type(value)
    return _names(kind)


@cache
def _names(kind: Any) -> tuple[str, ...] | None:
    if is_dataclass(kind):
        return tuple(declared.name for declared in fields(kind))
    return getattr(kind, "_fields", None)


def _layout(value: Any, kind: Any = None) -> np.dtype:
    """Use the declared types: an int given for a float must not cause another compilation."""
    if (names := field_names(value)) is not None:
        kinds = _types(type(value))  # type: ignore[arg-type]
        layouts = [(name, _layout(getattr(value, name), kinds[name])) for name in names]
        return np.dtype(layouts, align=True)
    if isinstance(value, np.ndarray):
        return np.dtype((value.dtype, value.shape))
    return np.dtype(kind)


@cache
def marks(group: type) -> dict[str, tuple[Any, ...]]:
    """What the fields of a named tuple or a memory are annotated with, such as SELECTS."""
    return {
        name: get_args(hint)[1:] if get_origin(hint) is Annotated else ()
        for name, hint in get_type_hints(group, include_extras=True).items()
    }


@cache
def _types(group: type) -> dict[str, Any]:
    return get_type_hints(group)


def _content(value: Any) -> Any:
    names = field_names(value)
    if names is None:
        return value
    return tuple(_content(getattr(value, name)) for name in names)
