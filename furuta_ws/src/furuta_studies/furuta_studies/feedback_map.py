"""Which feedbacks give limit cycles, and how large: a map over two parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

from furuta_analysis.describing_functions.predicted_cycles import predict_cycles
from furuta_analysis.describing_functions.transfer import transfer
from furuta_analysis.limit_cycles.ideal_loop import IdealLoop
from furuta_analysis.limit_cycles.limit_cycle import LimitCycle, limit_cycle
from furuta_analysis.simulation.batch import available_cores
from furuta_model.parameters import ParameterError


class StudyPoint(NamedTuple):
    """Exact motion at one pair of parameter values; IMPOSSIBLE where the values are refused.

    ``predicted_phi_peak_to_peak_rad`` is the largest stable cycle of the describing
    function, 0 for none.
    """

    first: float
    second: float
    cycle: LimitCycle
    predicted_phi_peak_to_peak_rad: float = 0.0


IMPOSSIBLE = LimitCycle("impossible")


def study(
    loop_at: Callable[[float, float], IdealLoop],
    firsts: Iterable[float],
    seconds: Iterable[float],
    workers: int | None = None,
) -> Iterator[StudyPoint]:
    """The exact motion over a grid, row by row, on all cores: compiled code frees the interpreter.

    The result of a point does not depend on any other, nor on the number of workers.
    """
    pairs = [(first, second) for first in firsts for second in seconds]

    def point(pair: tuple[float, float]) -> StudyPoint:
        try:
            loop = loop_at(*pair)
            return StudyPoint(*pair, limit_cycle(loop), predicted_size(loop))
        except ParameterError:
            return StudyPoint(*pair, IMPOSSIBLE)

    loop_at(*pairs[0]), loop_at(*pairs[-1])  # a name or range that is wrong throughout says so
    with ThreadPoolExecutor(workers or available_cores()) as pool:
        yield from pool.map(point, pairs)


def predicted_size(loop: IdealLoop) -> float:
    """Arm's travel [rad] that the describing function predicts, by the law's steady curve."""
    law = loop.law.named("stribeck") if loop.law.bristle else loop.law
    g = transfer(loop.body, (loop.l1, loop.l2, loop.l3, loop.l4))
    stable = (c.phi_peak_to_peak_rad for c in predict_cycles(g, law).cycles if c.stable)
    return max(stable, default=0.0)
