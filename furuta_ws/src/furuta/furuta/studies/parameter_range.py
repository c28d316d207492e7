"""Ranges of parameters on the command line, NAME=LOW:HIGH[:COUNT]."""

from __future__ import annotations

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_sim.settings.parameter_names import parameters_named

# Gains of u = l·x, which have names here although they are no parameters of a node.
GAINS = ("l1", "l2", "l3", "l4")
MAX_VALUES = 1000


def parse_range(text: str, default_count: int) -> tuple[str, np.ndarray]:
    """Name and values of NAME=LOW:HIGH or NAME=LOW:HIGH:COUNT."""
    name, _, rest = text.partition("=")
    parts = rest.split(":")
    try:
        low, high = float(parts[0]), float(parts[1])
        count = int(parts[2]) if len(parts) > 2 else default_count
    except (ValueError, IndexError):
        raise ParameterError(f"expected NAME=LOW:HIGH[:COUNT], given {text!r}") from None
    if len(parts) > 3 or not (np.isfinite([low, high]).all() and low < high):
        raise ParameterError(f"{name}: needs finite LOW < HIGH, given {rest!r}")
    if not 2 <= count <= MAX_VALUES:
        raise ParameterError(f"{name}: COUNT must be 2 to {MAX_VALUES}, given {count}")
    check_name(name.strip())
    return name.strip(), np.linspace(low, high, count)


def check_name(name: str) -> None:
    """Reject a name that is neither a parameter nor a gain before anything is computed."""
    if name not in GAINS:
        parameters_named(name)
