"""Map over two parameters: which feedbacks give limit cycles, and how large they are."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from math import nan
from typing import Any, NamedTuple

from furuta.describing_functions.predicted_cycles import predict_cycles
from furuta.lanes.batch import available_cores
from furuta.limit_cycles.limit_cycle import limit_cycle, state_at_rest
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.limit_cycles.periodic_orbit import LimitCycle
from furuta.transfer import transfer
from furuta_model.parameters import ParameterError

IMPOSSIBLE = "impossible"
# What a row of the map says about a cycle.
SHOWN = (
    *("kind", "phi_peak_to_peak_rad", "theta_peak_to_peak_rad", "period_s"),
    *("rotation_rate_rad_s", "stable"),
)


class MapPoint(NamedTuple):
    """Exact motion at one pair of parameter values, None if the values are rejected.

    ``predicted_phi_peak_to_peak_rad`` is the largest stable cycle that the describing
    function predicts, 0 for none.
    """

    first: float
    second: float
    cycle: LimitCycle | None
    predicted_phi_peak_to_peak_rad: float = 0.0

    @property
    def kind(self) -> str:
        """The kind of motion, or impossible."""
        return self.cycle.kind if self.cycle else IMPOSSIBLE

    def row(self, first: str, second: str) -> dict[str, Any]:
        """The point by name; ``first`` and ``second`` are the names of its parameters."""
        return {
            first: float(self.first),
            second: float(self.second),
            **{name: getattr(self, name, getattr(self.cycle, name, nan)) for name in SHOWN},
            "predicted_phi_peak_to_peak_rad": self.predicted_phi_peak_to_peak_rad,
        }


def map_feedbacks(
    loop_at: Callable[[float, float], IdealLoop],
    firsts: Iterable[float],
    seconds: Iterable[float],
    release: float = 0.05,
) -> Iterator[MapPoint]:
    """Compute the exact motion after a ``release`` [rad] over a grid, row by row, on all cores.

    Threads suffice because compiled code releases the interpreter lock. The result of a point does
    not depend on other points.

    Raises:
        ParameterError: No point is possible; with the reason for the first.
    """
    pairs = [(first, second) for first in firsts for second in seconds]

    def point(pair: tuple[float, float]) -> MapPoint:
        try:
            loop = loop_at(*pair)
            return MapPoint(
                *pair, limit_cycle(loop, state_at_rest(release)), predicted_peak_to_peak(loop)
            )
        except ParameterError as error:
            reasons[pair] = str(error)
            return MapPoint(*pair, None)

    reasons: dict[tuple[float, float], str] = {}
    with ThreadPoolExecutor(available_cores()) as pool:
        yield from pool.map(point, pairs)
    if len(reasons) == len(pairs):
        raise ParameterError(f"no point of the map is possible: {reasons[pairs[0]]}")


def predicted_peak_to_peak(loop: IdealLoop) -> float:
    """The arm's peak-to-peak angle [rad] that the describing function of the law predicts, or 0."""
    g = transfer(loop.body, loop.gains)
    stable = (c.phi_peak_to_peak_rad for c in predict_cycles(g, loop.law).cycles if c.stable)
    return max(stable, default=0.0)
