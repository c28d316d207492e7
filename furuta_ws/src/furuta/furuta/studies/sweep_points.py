"""The parameter values of a sweep: a grid, random points or a Sobol sequence."""

from collections.abc import Iterator, Sequence
from itertools import chain, count, islice, product
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import qmc

from furuta.studies.analysis_options import parse_range
from furuta_model.parameters import ParameterError
from furuta_sim.settings.parameter_names import parameters_named

METHODS = ("grid", "random", "sobol")
MAX_POINTS = 10_000_000
# Points that are drawn together: a power of two, which a Sobol sequence needs.
DRAWN = 1024

# Values of the swept parameters in one run, by name.
Point = dict[str, Any]


class SweptParameter(NamedTuple):
    """A parameter and its values: those of a grid, whose ends are a range, or a list."""

    name: str
    values: tuple[Any, ...]
    is_list: bool

    def value_at(self, fraction: float) -> Any:
        """The value at a ``fraction`` (0 to 1) of the range or of the list."""
        if self.is_list:
            return self.values[min(int(fraction * len(self.values)), len(self.values) - 1)]
        low, high = self.values[0], self.values[-1]
        value = low + fraction * (high - low)
        return round(value) if isinstance(low, int) else value


def parse_swept_parameter(text: str, default_count: int) -> SweptParameter:
    """Parse NAME=LOW:HIGH[:COUNT] or NAME=VALUE,VALUE,..."""
    name, separator, rest = text.partition("=")
    name = name.strip()
    if not separator or not rest:
        raise ParameterError(f"expected NAME=LOW:HIGH[:COUNT] or NAME=VALUE,VALUE, given {text!r}")
    (_, first), *_ = parameters_named(name)
    if ":" not in rest:
        return SweptParameter(name, tuple(rest.split(",")), True)
    if first.kind not in (float, int):
        raise ParameterError(f"{name} has no range; list its values: {name}=VALUE,VALUE")
    integer = first.kind is int
    _, values = parse_range(text, default_count)
    numbers = dict.fromkeys(round(float(v)) if integer else float(v) for v in values)
    return SweptParameter(name, tuple(numbers), False)


def count_points(parameters: Sequence[SweptParameter], method: str, points: int) -> int:
    """The number of points of the sweep."""
    if len({parameter.name for parameter in parameters}) < len(parameters):
        raise ParameterError("a parameter of a sweep may be named only once")
    total = points
    if method == "grid":
        total = 1
        for parameter in parameters:
            total *= len(parameter.values)
    if not 1 <= total <= MAX_POINTS:
        raise ParameterError(f"a sweep has 1 to {MAX_POINTS} points, given {total}")
    return total


def generate_points(
    parameters: Sequence[SweptParameter], method: str, points: int, seed: int
) -> Iterator[Point]:
    """Generate the points in order. The same arguments give the same points."""
    names = [parameter.name for parameter in parameters]
    if method == "grid":
        for values in product(*(parameter.values for parameter in parameters)):
            yield dict(zip(names, values, strict=True))
        return
    for row in _unit_cube_points(len(parameters), method, points, seed):
        yield {p.name: p.value_at(float(x)) for p, x in zip(parameters, row, strict=True)}


def _unit_cube_points(dimensions: int, method: str, points: int, seed: int) -> Iterator[np.ndarray]:
    """Points of the unit cube, random or of a scrambled Sobol sequence."""
    if method == "random":
        draw = np.random.default_rng(seed).random
        blocks = (draw((DRAWN, dimensions)) for _ in count())
    else:
        sequence = qmc.Sobol(dimensions, rng=seed)
        blocks = (sequence.random(DRAWN) for _ in count())
    yield from islice(chain.from_iterable(blocks), points)
