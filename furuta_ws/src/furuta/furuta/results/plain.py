"""Values as JSON has them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any


def plain(value: Any) -> Any:
    """The value without numpy, named tuples and results.

    A complex number is its real and imaginary part. None is what JSON does not have: NaN and
    infinity.
    """
    if hasattr(value, "tolist"):  # of numpy, which help does not load
        value = value.tolist()
    if hasattr(value, "_asdict"):
        value = value._asdict()
    elif hasattr(value, "to_dict"):
        value = value.to_dict()
    if isinstance(value, complex):
        value = [value.real, value.imag]
    if isinstance(value, Mapping):
        return {name: plain(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [plain(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
