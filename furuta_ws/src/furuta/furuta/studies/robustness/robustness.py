"""The residual over uncertain rigs: how often it is small, how often the pendulum falls.

The residual is the arm's peak-to-peak angle in the settled part of a run. A fall counts as an
infinite residual.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import binom, norm, sobol_indices, uniform

from furuta.studies.estimates import CONFIDENCE, Estimate, fraction
from furuta.studies.robustness.uncertain_rigs import UncertainRigs
from furuta_model.parameters import ParameterError
from furuta_sim.lanes.batch import batch
from furuta_sim.simulation.closed_loop import Loop, Outcome

# The quantile of the residual that is reported and minimised.
QUANTILE = 0.95
# Residual [rad] that a fall counts as, and the largest one, in Sobol indices, which need a number.
LARGEST_RESIDUAL = 2.0


class RigStudy(NamedTuple):
    """A run on each of the first ``size`` rigs of a ``seed``: a study that can be resumed."""

    rigs: UncertainRigs
    size: int
    seed: int
    seconds: float

    def remaining_loops(self, done: Container[int]) -> Iterator[tuple[int, Loop]]:
        """The loop of every run that is not ``done``. ParameterError if a rig is impossible."""
        for number, point in zip(range(self.size), self.rigs.points(self.seed), strict=False):
            if number not in done:
                yield number, self.rigs.loop_at(point, self.rigs.nominal.plant.seed + number)

    def values(self) -> Iterator[dict[str, float]]:
        """The uncertain values of every rig, by name."""
        for _, point in zip(range(self.size), self.rigs.points(self.seed), strict=False):
            yield self.rigs.values_at(point)


class Robustness(NamedTuple):
    """Result over all rigs; residuals in radians, infinite after a fall.

    ``p95_low_rad`` and ``p95_high_rad`` are the confidence interval of the quantile, from the order
    of the residuals alone. ``worst_rad`` is the largest residual without a fall.
    """

    runs: int
    within_bound: Estimate
    fell: Estimate
    falls: int
    p95_rad: float
    p95_low_rad: float
    p95_high_rad: float
    worst_rad: float


class Sensitivity(NamedTuple):
    """Sobol indices of an uncertain parameter: alone, and with all interactions."""

    parameter: str
    first_order: float
    total: float


def residual(found: Outcome | dict[str, Any]) -> float:
    """The residual of a run [rad]."""
    result = found._asdict() if isinstance(found, Outcome) else found
    return np.inf if result["fell"] else float(result["phi_peak_to_peak_rad"])


def residuals(loops: Iterable[Loop], seconds: float) -> Iterator[float]:
    """The residual of each loop [rad], in order."""
    return map(residual, batch(loops, seconds))


def robustness(found: np.ndarray, bound: float) -> Robustness:
    """Evaluate the residuals [rad] against a ``bound`` [rad]."""
    ordered = np.sort(found)
    falls = int(np.sum(np.isinf(found)))
    low, high = binom.interval(CONFIDENCE, len(found), QUANTILE)
    standing = ordered[: len(found) - falls]
    return Robustness(
        len(found),
        fraction(int(np.sum(found <= bound)), len(found)),
        fraction(falls, len(found)),
        falls,
        quantile(ordered),
        float(ordered[max(int(low) - 1, 0)]),
        float(ordered[min(int(high), len(found) - 1)]),
        float(standing[-1]) if len(standing) else np.inf,
    )


def quantile(found: np.ndarray) -> float:
    """The smallest residual [rad] that :data:`QUANTILE` of all do not exceed."""
    return float(np.quantile(found, QUANTILE, method="inverted_cdf"))


def sobol(
    rigs: UncertainRigs, points: int, seed: int, seconds: float, advance: Callable[[], None]
) -> list[Sensitivity]:
    """Sobol indices of the residual, by Saltelli's design with ``points`` (a power of two).

    It takes ``points`` times the number of parameters plus two runs, all with the same noise. The
    indices exist only for values that vary independently.
    """
    covariance = rigs.uncertainty.covariance
    if np.any(covariance != np.diag(np.diag(covariance))):
        raise ParameterError("Sobol indices need independent values; those of the rig correlate")
    errors = rigs.uncertainty.standard_errors
    if set(errors) & set(rigs.ranges) or 0.0 in errors.values():
        raise ParameterError("Sobol indices need values that all vary, and each in one way")

    def evaluate(x: np.ndarray) -> np.ndarray:
        found = []
        for each in residuals(rigs.loops_at(x.T), seconds):
            found.append(min(each, LARGEST_RESIDUAL))
            advance()
        return np.array(found)

    distributions = [norm(scale=error) for error in errors.values()]
    distributions += [uniform()] * len(rigs.ranges)
    indices = sobol_indices(func=evaluate, n=points, dists=distributions, rng=seed)
    rows = zip(rigs.names, indices.first_order, indices.total_order, strict=True)
    return [Sensitivity(name, float(first), float(total)) for name, first, total in rows]
