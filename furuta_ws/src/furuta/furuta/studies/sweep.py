"""A sweep: many closed loops over some parameters, run on all cores of this machine."""

from collections import deque
from collections.abc import Container, Iterator
from typing import Any, NamedTuple

from furuta.studies.sweep_points import Point, SweptParameter, count_points, generate_points
from furuta_model.parameters import ParameterError
from furuta_sim.lanes.batch import batch
from furuta_sim.settings.settings import Settings, loop_with
from furuta_sim.simulation.closed_loop import Loop, Outcome

NO_OUTCOME = dict.fromkeys(Outcome._fields)

# Number of a run, and its outcome or the reason why its parameters are impossible.
RunResult = tuple[int, dict[str, Any]]


class Sweep(NamedTuple):
    """Base settings, swept parameters, how their values are chosen, and seconds per run."""

    settings: Settings
    axes: tuple[SweptParameter, ...]
    method: str
    points: int
    seed: int
    seconds: float

    @property
    def size(self) -> int:
        """The number of runs."""
        return count_points(self.axes, self.method, self.points)

    def generate_points(self) -> Iterator[Point]:
        """Generate the parameter values of every run."""
        return generate_points(self.axes, self.method, self.points, self.seed)

    def remaining_loops(self, done: Container[int]) -> Iterator[tuple[int, Loop | str]]:
        """The loop of every run that is not ``done``, or the reason why it is impossible."""
        for number, point in enumerate(self.generate_points()):
            if number not in done:
                try:
                    yield number, loop_with(self.settings, point)
                except ParameterError as error:
                    yield number, str(error)


def finished_run(number: int, outcome: Outcome) -> RunResult:
    """The result of a run."""
    return number, {**outcome._asdict(), "error": ""}


def impossible_run(number: int, reason: str) -> RunResult:
    """The result of a run whose parameters are rejected."""
    return number, {**NO_OUTCOME, "error": reason}


def run_locally(sweep: Sweep, done: Container[int]) -> Iterator[RunResult]:
    """Run what is not ``done`` on all cores, and yield the results."""
    numbers: deque[int] = deque()
    impossible: deque[RunResult] = deque()

    def possible_loops() -> Iterator[Loop]:
        for number, loop_or_reason in sweep.remaining_loops(done):
            if isinstance(loop_or_reason, str):
                impossible.append(impossible_run(number, loop_or_reason))
            else:
                numbers.append(number)
                yield loop_or_reason

    for outcome in batch(possible_loops(), sweep.seconds):
        yield finished_run(numbers.popleft(), outcome)
        while impossible:
            yield impossible.popleft()
    yield from impossible
