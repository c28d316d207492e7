"""Checks a rig file: does the loop hold on every rig that its uncertainty allows?

Plants are drawn from the rig's uncertainty. Estimator, friction observer and controller have the
rig's own values, as on the real rig. All plants are simulated with every compensation.
"""

from __future__ import annotations

from itertools import islice
from typing import NamedTuple

import numpy as np
from scipy.stats import rankdata

from furuta.studies.comparison.candidates import Candidate, parse_candidates
from furuta.studies.estimates import fraction_below
from furuta.studies.robustness.robustness import residual
from furuta.studies.robustness.uncertain_rigs import UncertainRigs
from furuta_friction.compensation import COMPENSATIONS
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.uncertainty import Uncertainty
from furuta_sim.lanes.batch import batch
from furuta_sim.settings.settings import loop, rig_settings
from furuta_sim.simulation.closed_loop import Outcome

# Rank correlation below which a value hardly changes the residual.
SMALLEST_CORRELATION = 0.3
# Candidates that are tried, by name.
CHOICES = (*COMPENSATIONS, "super_twisting")


class Row(NamedTuple):
    """A compensation on all rigs: residuals of the arm, peak to peak, of those that stand."""

    compensation: str
    falls: int
    median_rad: float
    p95_rad: float
    worst_rad: float
    command_rms_v: float


class RigCheck(NamedTuple):
    """Rows for all compensations, the recommended one, and what changes its residual most.

    ``falls_below`` is the upper confidence limit of the recommended one's share of falls.
    """

    rigs: int
    rows: list[Row]
    recommended: str | None
    falls_below: float
    influences: dict[str, float]


def check_rig(rig: Rig, uncertainty: Uncertainty, rigs: int, seconds: float, seed: int) -> RigCheck:
    """Simulate ``rigs`` plants, each for ``seconds`` with every compensation."""
    settings = rig_settings(rig)
    candidates = parse_candidates(CHOICES, settings, tuned=False)

    def rigs_with(candidate: Candidate) -> UncertainRigs:
        return UncertainRigs(loop(candidate.applied_to(settings)), {}, rig, uncertainty)

    found = {
        each.name: list(batch(rigs_with(each).loops(rigs, seed), seconds)) for each in candidates
    }
    rows = [_row(name, outcomes) for name, outcomes in found.items()]
    standing = [row for row in rows if row.falls == 0]
    best = min(standing, key=lambda row: row.p95_rad).compensation if standing else None
    judged = found[best or "none"]
    falls = sum(each.fell for each in judged)
    changes = np.array(list(islice(rigs_with(candidates[0]).points(seed), rigs)))
    return RigCheck(
        rigs,
        rows,
        best,
        fraction_below(falls, rigs),
        influences(uncertainty.names, changes, judged),
    )


def _row(name: str, outcomes: list[Outcome]) -> Row:
    standing = [each for each in outcomes if not each.fell]
    residuals = [each.phi_peak_to_peak_rad for each in standing] or [float("nan")]
    median, p95 = (float(each) for each in np.percentile(residuals, (50.0, 95.0)))
    command = float(np.median([each.command_rms_v for each in standing] or [float("nan")]))
    return Row(name, len(outcomes) - len(standing), median, p95, max(residuals), command)


def influences(
    names: tuple[str, ...], changes: np.ndarray, outcomes: list[Outcome]
) -> dict[str, float]:
    """Rank correlation of each uncertain value with the residual, the largest first.

    A rig that fell counts as one with the largest residual. Weak correlations are left out.
    """
    ranks = rankdata([residual(each) for each in outcomes])
    if np.ptp(ranks) == 0.0:
        return {}
    found = {}
    for name, change in zip(names, changes.T, strict=True):
        if np.ptp(change) > 0.0:
            found[name] = float(np.corrcoef(rankdata(change), ranks)[0, 1])
    strong = {n: each for n, each in found.items() if abs(each) >= SMALLEST_CORRELATION}
    return dict(sorted(strong.items(), key=lambda item: -abs(item[1])))
