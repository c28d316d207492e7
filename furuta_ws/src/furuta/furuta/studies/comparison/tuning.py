"""Tunes candidates with one budget on rigs that are not judged.

The criterion is the mean over the tuning rigs of the arm's peak-to-peak angle. A run outside the
guard, or with a fall, counts as the guard. The start is the first evaluation, so a tuned candidate
is never worse than its start on these rigs.
"""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from furuta.lanes.batch import batch
from furuta.studies.comparison.candidates import Candidate, Range, current_values
from furuta.studies.comparison.comparison import residual
from furuta.studies.comparison.rigs import SimulatedRig
from furuta.studies.trust_region import SEARCH, search
from furuta_graph.settings.settings import Settings, loop
from furuta_model.parameters import ParameterError
from furuta_sim.parameters import PlantParameters

# Number of random rigs to tune on.
TUNING_RIGS = 10
# Largest peak-to-peak angle of the arm that counts [rad].
ARM_GUARD = 2.0
# First and last radius of the trust region, relative to the range.
RADII = (0.1, 0.01)


class TuningBudget(NamedTuple):
    """Evaluations per candidate, the rigs of an evaluation, and seconds per run."""

    evaluations: int
    rigs: Iterable[SimulatedRig]
    seconds: float


class TunedCandidate(NamedTuple):
    """Name and tuned settings of a candidate, the criterion [rad] before and after, the search."""

    candidate: str
    settings: dict[str, Any]
    before: float
    after: float
    evaluations: int
    search: str = SEARCH


def tune_candidate(
    candidate: Candidate, settings: Settings, budget: TuningBudget
) -> TunedCandidate:
    """Tune the parameters of ``candidate`` that have a range."""
    plants = _plants(settings, budget.rigs)
    tried: list[tuple[float, Candidate]] = []

    def criterion(point: np.ndarray) -> float:
        """The criterion [rad] at a point of the cube that the ranges span."""
        pairs = zip(candidate.ranges.items(), point, strict=True)
        values = {name: value_at(float(x), limits) for (name, limits), x in pairs}
        chosen = candidate._replace(settings=candidate.settings | values)
        try:
            control = loop(chosen.applied_to(settings))
            loops = (control._replace(plant=plant) for plant in plants)
            sizes = [min(residual(run), ARM_GUARD) for run in batch(loops, budget.seconds)]
            size = float(np.mean(sizes))
        except ParameterError:  # an impossible candidate counts as the guard
            size = ARM_GUARD
        tried.append((size, chosen))
        return size

    now = current_values(candidate.applied_to(settings), candidate.ranges)
    pairs = zip(now, candidate.ranges.values(), strict=True)
    start = np.array([fraction(value, limits) for value, limits in pairs])
    before = criterion(start)
    if len(start) and budget.evaluations > 1:
        search(criterion, start, RADII, budget.evaluations - 1, [(0.0, 1.0)] * len(start))
    after, best = min(tried, key=lambda trial: trial[0])
    return TunedCandidate(candidate.name, best.settings, before, after, len(tried))


def value_at(x: float, limits: Range) -> float:
    """The value at a fraction of a range, on a logarithmic scale if the range is positive."""
    low, high = limits
    x = min(max(x, 0.0), 1.0)
    value = low * (high / low) ** x if low > 0.0 else low + (high - low) * x
    return min(max(value, low), high)


def fraction(value: float, limits: Range) -> float:
    """The inverse of :func:`value_at`, for values outside the nearer end."""
    low, high = limits
    value = min(max(value, low), high)
    if low > 0.0:
        return float(np.log(value / low) / np.log(high / low))
    return (value - low) / (high - low)


def _plants(settings: Settings, rigs: Iterable[SimulatedRig]) -> list[PlantParameters]:
    """The plants of the tuning rigs that are possible."""
    plants = []
    for rig in rigs:
        try:
            plants.append(rig.plant(settings))
        except ParameterError:
            continue
    if not plants:
        raise ParameterError("none of the tuning rigs is possible")
    return plants
