"""Ranges of parameters as they are typed."""

import numpy as np

from furuta_model.parameters import ParameterError

MAX_VALUES = 1000


def parse_range(text: str, default_count: int) -> tuple[str, np.ndarray]:
    """Name and values of NAME=LOW:HIGH or NAME=LOW:HIGH:COUNT."""
    name, _, rest = text.partition("=")
    parts = rest.split(":")
    try:
        low, high = float(parts[0]), float(parts[1])
        count = int(parts[2]) if len(parts) > 2 else default_count
    except (ValueError, IndexError):
        raise ParameterError(
            f"expected NAME=LOW:HIGH[:COUNT], such as omega1=2:12, given {text!r}"
        ) from None
    if len(parts) > 3 or not (np.isfinite([low, high]).all() and low < high):
        raise ParameterError(f"{name}: needs finite LOW < HIGH, given {rest!r}")
    if not 2 <= count <= MAX_VALUES:
        raise ParameterError(f"{name}: COUNT must be 2 to {MAX_VALUES}, given {count}")
    return name.strip(), np.linspace(low, high, count)
