"""Packs parameters or a memory into one block, which compiled code reads and writes by name.

Parameters are named tuples, a memory is a dataclass; both hold numbers, arrays and groups of their
own kind. In compiled code ``block[0]`` has their fields. A call from Python unpacks a named tuple
field by field, which takes a microsecond for every ten fields, more than the arithmetic of the
sample. A block is passed as one argument.
"""

from dataclasses import field
from functools import cache, partial
from typing import Any

import numba
import numpy as np

from furuta_model.parameters import fields_of


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


def _layout(value: Any, kind: Any = None) -> np.dtype:
    """Use the declared types: an int given for a float must not cause another compilation."""
    if fields := fields_of(value):
        layouts = [(name, _layout(getattr(value, name), kind)) for name, kind, _ in fields]
        return np.dtype(layouts, align=True)
    if isinstance(value, np.ndarray):
        return np.dtype((value.dtype, value.shape))
    return np.dtype(kind)


def _content(value: Any) -> Any:
    fields = fields_of(value)
    return tuple(_content(getattr(value, name)) for name, _, _ in fields) if fields else value
