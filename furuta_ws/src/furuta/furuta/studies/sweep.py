"""A sweep: many closed loops over every combination of some values, here or on a cluster."""

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import fields
from functools import partial
from itertools import islice, product
from math import prod
from typing import Any, NamedTuple

from furuta.lanes.batch import batch, outcomes
from furuta.outcomes import Outcome
from furuta.settings.parameter_names import parameters_named
from furuta.settings.settings import Settings, loop_with
from furuta.studies.ranges import parse_range
from furuta_model.accepted_parts import accept_parts, accepted_parts
from furuta_model.parameters import ParameterError, names_part, number_from_text
from furuta_ros.errors import UserError
from furuta_sim.simulation.closed_loop import Loop

MAX_POINTS = 10_000_000
# Runs of a task of the cluster, and tasks that are sent together.
RUNS_PER_TASK, TASKS = 8, 1000
# Attempts at a task that fails, and longest wait for the scheduler's answer [s].
RETRIES, CONNECT_TIMEOUT = 3, 5.0
NO_OUTCOME = dict.fromkeys(each.name for each in fields(Outcome))

# Values of the swept parameters in one run, by name.
Point = dict[str, Any]
# Outcome of a run and the reason, which is empty, why its parameters are impossible.
Result = dict[str, Any]
# Gives the outcomes of loops over some seconds, in order.
Simulate = Callable[[Iterator[Loop], float], Iterator[Outcome]]


class SweptParameter(NamedTuple):
    """A parameter and its values."""

    name: str
    values: tuple[Any, ...]


def parse_swept_parameter(text: str, default_count: int) -> SweptParameter:
    """Parse NAME=LOW:HIGH[:COUNT] or NAME=VALUE,VALUE,..."""
    name, _, rest = text.partition("=")
    name = name.strip()
    expected = ParameterError(
        "expected NAME=LOW:HIGH[:COUNT] or NAME=VALUE,VALUE, such as alpha0=0.1:0.3:5, "
        f"given {text!r}"
    )
    if not rest:
        raise expected
    (_, first), *_ = parameters_named(name)
    is_number = first.kind in (float, int)
    if ":" not in rest or (first.about.own and names_part(rest)):
        values = tuple(rest.split(","))
        if is_number and not all(isinstance(number_from_text(each), float) for each in values):
            raise expected
        return SweptParameter(name, values)
    if not is_number:
        raise ParameterError(f"{name} has no range; list its values: {name}=VALUE,VALUE")
    integer = first.kind is int
    _, numbers = parse_range(text, default_count)
    distinct = dict.fromkeys(round(float(v)) if integer else float(v) for v in numbers)
    return SweptParameter(name, tuple(distinct))


class Sweep(NamedTuple):
    """Base settings, swept parameters and seconds per run."""

    settings: Settings
    axes: tuple[SweptParameter, ...]
    seconds: float

    def size(self) -> int:
        """The number of runs; :class:`ParameterError` if there are too many."""
        if len({axis.name for axis in self.axes}) < len(self.axes):
            raise ParameterError("a parameter of a sweep may be named only once")
        total = prod(len(axis.values) for axis in self.axes)
        if total > MAX_POINTS:
            raise ParameterError(f"a sweep has at most {MAX_POINTS} points, given {total}")
        return total

    def points(self) -> Iterator[Point]:
        """Every combination of the values, in order; the last parameter changes fastest."""
        names = [axis.name for axis in self.axes]
        for values in product(*(axis.values for axis in self.axes)):
            yield dict(zip(names, values, strict=True))

    def loops(self) -> Iterator[Loop | str]:
        """The loop of every run, or the reason why it is impossible."""
        for point in self.points():
            try:
                yield loop_with(self.settings, point)
            except ParameterError as error:
                yield str(error)


def run(sweep: Sweep, simulate: Simulate = batch) -> Iterator[Result]:
    """Run everything, by default on all cores; the results in order."""
    waiting: deque[Loop | str] = deque()

    def possible_loops() -> Iterator[Loop]:
        for loop_or_reason in sweep.loops():
            waiting.append(loop_or_reason)
            if not isinstance(loop_or_reason, str):
                yield loop_or_reason

    for outcome in simulate(possible_loops(), sweep.seconds):
        while isinstance(reason := waiting.popleft(), str):
            yield {**NO_OUTCOME, "error": reason}
        yield {**vars(outcome), "error": ""}
    yield from ({**NO_OUTCOME, "error": str(reason)} for reason in waiting)


def outcomes_on_cluster(address: str, loops: Iterator[Loop], seconds: float) -> Iterator[Outcome]:
    """The outcomes of loops in order, from a Dask cluster whose workers have this workspace.

    Dask repeats the tasks of a worker that dies.
    """
    from distributed import Client, KilledWorker

    try:
        client = Client(address, timeout=CONNECT_TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as error:
        raise UserError(f"no Dask scheduler answers at {address}: {error}") from None
    task = partial(_task, accepted_parts(), seconds)
    chunks = iter(lambda: list(islice(loops, RUNS_PER_TASK)), [])
    with client:
        while block := list(islice(chunks, TASKS)):
            futures = client.map(task, block, retries=RETRIES, pure=False)
            try:
                for done in client.gather(futures):
                    yield from done
            except (ImportError, RuntimeError, KilledWorker) as error:
                raise UserError(f"the workers of the cluster cannot run it: {error}") from None


def _task(parts: list[str], seconds: float, loops: list[Loop]) -> list[Outcome]:
    """The outcomes of some loops, whose parts the client of the cluster accepts."""
    accept_parts(parts)
    return outcomes(loops, seconds)
