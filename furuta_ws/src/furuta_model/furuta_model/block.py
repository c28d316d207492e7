"""Packs parameters into one block of memory, for the nodes' calls of compiled code.

A call from Python unpacks a named tuple field by field. That takes a microsecond for every ten
fields, more than the arithmetic of the sample. A block is passed as one argument. In compiled code
``block[0]`` has the fields of the tuple.
"""

from __future__ import annotations

from typing import Any, NamedTuple, get_type_hints

import numpy as np


def block(parameters: NamedTuple) -> np.ndarray:
    """Pack the numbers, arrays and named tuples of a named tuple into a structured array (1,)."""
    packed = np.zeros(1, _layout(parameters))
    packed[0] = _content(parameters)
    return packed


def _layout(value: Any, kind: Any = None) -> np.dtype:
    """Use the declared types: an int given for a float must not cause another compilation."""
    if hasattr(value, "_fields"):
        kinds = get_type_hints(type(value))
        fields = zip(value._fields, value, strict=True)
        return np.dtype([(name, _layout(each, kinds[name])) for name, each in fields], align=True)
    if isinstance(value, np.ndarray):
        return np.dtype((value.dtype, value.shape))
    return np.dtype(kind)


def _content(value: Any) -> Any:
    return tuple(map(_content, value)) if hasattr(value, "_fields") else value
