"""Parameters in one block of memory, for the nodes' calls of compiled code.

A call from Python takes a named tuple apart field by field, which costs a microsecond for every
ten and so more than the sample's arithmetic; a block is handed on whole. In compiled code its
``block[0]`` has the tuple's fields.
"""

from __future__ import annotations

from typing import Any, NamedTuple, get_type_hints

import numpy as np


def block(parameters: NamedTuple) -> np.ndarray:
    """The numbers, arrays and named tuples of a named tuple as a structured array (1,)."""
    made = np.zeros(1, _layout(parameters))
    made[0] = _content(parameters)
    return made


def _layout(value: Any, kind: Any = None) -> np.dtype:
    """By the declared types: an int in a float's place must not ask for another compilation."""
    if hasattr(value, "_fields"):
        kinds = get_type_hints(type(value))
        fields = zip(value._fields, value, strict=True)
        return np.dtype([(name, _layout(each, kinds[name])) for name, each in fields], align=True)
    if isinstance(value, np.ndarray):
        return np.dtype((value.dtype, value.shape))
    return np.dtype(kind)


def _content(value: Any) -> Any:
    return tuple(map(_content, value)) if hasattr(value, "_fields") else value
