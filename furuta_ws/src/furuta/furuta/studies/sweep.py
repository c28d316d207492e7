"""A sweep: many closed loops over some parameters, on a grid or a Sobol sequence."""

from collections import deque
from collections.abc import Iterator
from itertools import chain, count, islice, product
from math import prod
from typing import Any, NamedTuple

from scipy.stats import qmc

from furuta.studies.analysis_options import parse_range
from furuta_model.parameters import ParameterError
from furuta_sim.lanes.batch import batch
from furuta_sim.settings.parameter_names import parameters_named
from furuta_sim.settings.settings import Settings, loop_with
from furuta_sim.simulation.closed_loop import Loop, Outcome

METHODS = ("grid", "sobol")
MAX_POINTS = 10_000_000
# Points that are drawn together: a power of two, which a Sobol sequence needs.
DRAWN = 1024
NO_OUTCOME = dict.fromkeys(Outcome._fields)

# Values of the swept parameters in one run, by name.
Point = dict[str, Any]
# Outcome of a run and the reason, which is empty, why its parameters are impossible.
Result = dict[str, Any]


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


class Sweep(NamedTuple):
    """Base settings, swept parameters, how their values are chosen, and seconds per run."""

    settings: Settings
    axes: tuple[SweptParameter, ...]
    method: str
    points: int
    seed: int
    seconds: float

    def size(self) -> int:
        """The number of runs; :class:`ParameterError` if there are too many or none."""
        if len({axis.name for axis in self.axes}) < len(self.axes):
            raise ParameterError("a parameter of a sweep may be named only once")
        grid = self.method == "grid"
        total = prod(len(axis.values) for axis in self.axes) if grid else self.points
        if not 1 <= total <= MAX_POINTS:
            raise ParameterError(f"a sweep has 1 to {MAX_POINTS} points, given {total}")
        return total

    def generate_points(self) -> Iterator[Point]:
        """Generate the parameter values of every run, in order."""
        names = [axis.name for axis in self.axes]
        if self.method == "grid":
            for values in product(*(axis.values for axis in self.axes)):
                yield dict(zip(names, values, strict=True))
            return
        sequence = qmc.Sobol(len(self.axes), rng=self.seed)
        drawn = chain.from_iterable(sequence.random(DRAWN) for _ in count())
        for row in islice(drawn, self.points):
            pairs = zip(self.axes, row, strict=True)
            yield {axis.name: axis.value_at(float(x)) for axis, x in pairs}

    def loops(self, first: int) -> Iterator[Loop | str]:
        """The loop of every run from number ``first`` on, or the reason why it is impossible."""
        for point in islice(self.generate_points(), first, None):
            try:
                yield loop_with(self.settings, point)
            except ParameterError as error:
                yield str(error)


def finished_run(outcome: Outcome) -> Result:
    """The result of a run."""
    return {**outcome._asdict(), "error": ""}


def impossible_run(reason: str) -> Result:
    """The result of a run whose parameters are rejected."""
    return {**NO_OUTCOME, "error": reason}


def run_locally(sweep: Sweep, first: int) -> Iterator[Result]:
    """Run everything from number ``first`` on, on all cores; yields the results in order."""
    waiting: deque[Loop | str] = deque()

    def possible_loops() -> Iterator[Loop]:
        for loop_or_reason in sweep.loops(first):
            waiting.append(loop_or_reason)
            if not isinstance(loop_or_reason, str):
                yield loop_or_reason

    for outcome in batch(possible_loops(), sweep.seconds):
        while isinstance(reason := waiting.popleft(), str):
            yield impossible_run(reason)
        yield finished_run(outcome)
    yield from (impossible_run(str(reason)) for reason in waiting)
