"""Tunes candidates with one budget on rigs that are not judged.

The criterion is the mean over the tuning rigs of the arm's peak-to-peak angle. A run outside the
guard, or with a fall, counts as the guard. The start is the first evaluation, so a tuned candidate
is never worse than its start on these rigs.
"""

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import minimize

from furuta.studies.comparison.candidates import Candidate, Range, current_values
from furuta.studies.comparison.comparison import residual
from furuta.studies.comparison.named_rigs import SimulatedRig
from furuta_model.parameters import ParameterError
from furuta_sim.lanes.batch import batch
from furuta_sim.parameters import PlantParameters
from furuta_sim.settings.settings import Settings, loop

# Largest peak-to-peak angle of the arm that counts [rad].
ARM_GUARD = 2.0
# First and last radius of the trust region, relative to the range.
FIRST_RADIUS, LAST_RADIUS = 0.1, 0.01


class TuningBudget(NamedTuple):
    """Evaluations per candidate, the rigs of an evaluation, and seconds per run."""

    evaluations: int
    rigs: Iterable[SimulatedRig]
    seconds: float


class TunedCandidate(NamedTuple):
    """Name and tuned settings of a candidate, and the criterion [rad] before and after."""

    candidate: str
    settings: dict[str, Any]
    before: float
    after: float
    evaluations: int

    @property
    def as_candidate(self) -> Candidate:
        """The candidate with what was tuned."""
        return Candidate(self.candidate, self.settings, {})


def tune_candidates(
    candidates: Iterable[Candidate], settings: Settings, budget: TuningBudget
) -> Iterator[TunedCandidate]:
    """Tune every candidate with the same budget."""
    return (tune_candidate(candidate, settings, budget) for candidate in candidates)


def tune_candidate(
    candidate: Candidate, settings: Settings, budget: TuningBudget
) -> TunedCandidate:
    """Tune the parameters of ``candidate`` that have a range, with COBYQA."""
    search = _Search(candidate, settings, budget)
    start = search.start()
    before = search.evaluate(start)
    if len(start) and budget.evaluations > 1:
        search.minimise(start, budget.evaluations - 1)
    return TunedCandidate(
        candidate.name, search.best.settings, before, search.lowest, search.evaluations
    )


class _Search:
    """Evaluates points of the unit cube that the ranges span."""

    def __init__(self, candidate: Candidate, settings: Settings, budget: TuningBudget) -> None:
        self.best, self.lowest, self.evaluations = candidate, np.inf, 0
        self._candidate = candidate
        self._settings = settings
        self._seconds = budget.seconds
        self._plants = _plants(settings, budget.rigs)

    def start(self) -> np.ndarray:
        """The point of the present values, moved into the ranges."""
        ranges = self._candidate.ranges
        now = current_values(self._candidate.applied_to(self._settings), ranges)
        pairs = zip(now, ranges.values(), strict=True)
        return np.array([fraction(value, limits) for value, limits in pairs])

    def minimise(self, start: np.ndarray, evaluations: int) -> None:
        """Search from ``start``; the best point found is kept."""
        minimize(
            self.evaluate,
            start,
            method="COBYQA",
            bounds=[(0.0, 1.0)] * len(start),
            options={
                "maxfev": evaluations,
                "initial_tr_radius": FIRST_RADIUS,
                "final_tr_radius": LAST_RADIUS,
            },
        )

    def evaluate(self, point: np.ndarray) -> float:
        """The criterion [rad] at a point; an impossible candidate counts as the guard."""
        pairs = zip(self._candidate.ranges.items(), point, strict=True)
        values = {name: value_at(float(x), limits) for (name, limits), x in pairs}
        tried = self._candidate._replace(settings=self._candidate.settings | values)
        self.evaluations += 1
        try:
            criterion = self._criterion(tried)
        except ParameterError:
            return ARM_GUARD
        if criterion < self.lowest:
            self.best, self.lowest = tried, criterion
        return criterion

    def _criterion(self, candidate: Candidate) -> float:
        control = loop(candidate.applied_to(self._settings))
        loops = (control._replace(plant=plant) for plant in self._plants)
        outcomes = batch(loops, self._seconds)
        return float(np.mean([min(residual(outcome), ARM_GUARD) for outcome in outcomes]))


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
