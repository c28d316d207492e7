"""Unknowns as data: what a fit changes, within which range, and what is expected beforehand."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

# The name of an unknown, with a number if there are several: of a recording, or a wave's order.
Key = str | tuple[str, int]
# A value for each key, in the coordinate of the fit: the quantity, or its logarithm.
Values = Mapping[Key, float]


class Unknown(NamedTuple):
    """What a fit may change, in its coordinate.

    ``mean`` and ``spread`` are those of the prior, ``size`` is that of a usual change. A positive
    value changes by at most a ``factor`` in an iteration. ``step`` is that of finite differences,
    in sizes: large against the stairs that an integration has.
    """

    key: Key
    low: float = -math.inf
    high: float = math.inf
    mean: float = 0.0
    spread: float = math.inf
    size: float = 1.0
    factor: float = math.inf
    step: float = 1e-6


class Unknowns(tuple[Unknown, ...]):
    """Several unknowns, with their properties as vectors (p,)."""

    def __new__(cls, unknowns: Iterable[Unknown]) -> Unknowns:
        """Of these, in this order."""
        return super().__new__(cls, unknowns)

    @property
    def keys(self) -> tuple[Key, ...]:
        """Their keys."""
        return tuple(unknown.key for unknown in self)

    def all(self, field: str) -> np.ndarray:
        """One property of each."""
        return np.array([getattr(unknown, field) for unknown in self], dtype=float)

    def vector(self, values: Values) -> np.ndarray:
        """Their values."""
        return np.array([values[unknown.key] for unknown in self], dtype=float)

    def changed(self, values: Values, vector: Sequence[float] | np.ndarray) -> Values:
        """All values, with others for these unknowns."""
        return {**values, **dict(zip(self.keys, map(float, vector), strict=True))}

    def bounds(self, vector: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest values of the next iteration."""
        factor, limited = self.all("factor"), np.isfinite(self.all("factor"))
        down = np.where(limited, vector / factor, -np.inf)
        up = np.where(limited, vector * np.where(limited, factor, 1.0), np.inf)
        return np.maximum(self.all("low"), down), np.minimum(self.all("high"), up)


def field_of(key: Key) -> str:
    """A key without its number."""
    return key if isinstance(key, str) else key[0]


def name_of(key: Key) -> str:
    """A key in a report."""
    return key if isinstance(key, str) else f"{key[0]} {key[1]}"
