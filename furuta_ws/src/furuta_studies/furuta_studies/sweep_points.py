"""Which values a study tries: a grid, random points or a Sobol sequence over some parameters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import qmc

from furuta_graph.parameter_names import parameters_named
from furuta_model.parameters import ParameterError
from furuta_studies.ideal_loop import parse_range

METHODS = ("grid", "random", "sobol")
MOST_POINTS = 10_000_000

Point = dict[str, Any]


class Axis(NamedTuple):
    """A parameter and what it is given: values of a grid, ends of a range, or choices."""

    name: str
    values: tuple[Any, ...]
    choices: bool

    def at(self, share: float) -> Any:
        """The value at ``share`` (0 to 1) of the range, or that one of the choices."""
        if self.choices:
            return self.values[min(int(share * len(self.values)), len(self.values) - 1)]
        low, high = self.values[0], self.values[-1]
        value = low + share * (high - low)
        return round(value) if isinstance(low, int) else value


def parse_axis(text: str, default_count: int) -> Axis:
    """NAME=LOW:HIGH[:COUNT] or NAME=VALUE,VALUE,..."""
    name, separator, rest = text.partition("=")
    name = name.strip()
    if not separator or not rest:
        raise ParameterError(f"expected NAME=LOW:HIGH[:COUNT] or NAME=VALUE,VALUE, given {text!r}")
    (_, first), *_ = parameters_named(name)
    if ":" not in rest:
        return Axis(name, tuple(rest.split(",")), True)
    if first.kind not in (float, int):
        raise ParameterError(f"{name} has no range, name its values: {name}=VALUE,VALUE")
    whole = first.kind is int
    _, values = parse_range(text, default_count)
    numbers = dict.fromkeys(round(float(v)) if whole else float(v) for v in values)
    return Axis(name, tuple(numbers), False)


def size_of(axes: Sequence[Axis], method: str, points: int) -> int:
    """How many points the study has."""
    if len({axis.name for axis in axes}) < len(axes):
        raise ParameterError("every parameter of a sweep is named once")
    total = points
    if method == "grid":
        total = 1
        for axis in axes:
            total *= len(axis.values)
    if not 1 <= total <= MOST_POINTS:
        raise ParameterError(f"a sweep has 1 to {MOST_POINTS} points, given {total}")
    return total


def design(axes: Sequence[Axis], method: str, points: int, seed: int) -> Iterator[Point]:
    """The points in their order, the same for the same arguments."""
    names = [axis.name for axis in axes]
    if method == "grid":
        for values in product(*(axis.values for axis in axes)):
            yield dict(zip(names, values, strict=True))
        return
    for shares in _shares(len(axes), method, points, seed):
        yield {axis.name: axis.at(float(s)) for axis, s in zip(axes, shares, strict=True)}


def _shares(dimensions: int, method: str, points: int, seed: int) -> np.ndarray:
    """Points (n, dimensions) in the unit cube; of a Sobol sequence its first n, scrambled."""
    if method == "random":
        return np.random.default_rng(seed).random((points, dimensions))
    exponent = max(0, (points - 1).bit_length())
    shares: np.ndarray = qmc.Sobol(dimensions, rng=seed).random_base2(exponent)[:points]
    return shares
