"""Checks a rig file: does the loop hold on every rig that its uncertainty allows?

Plants are drawn from the rig's uncertainty. Estimator, friction observer and controller have the
rig's own values, as on the real rig. All plants are simulated with every compensation.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import beta, rankdata

from furuta_analysis.simulation.batch import batch
from furuta_analysis.simulation.closed_loop import Loop, Outcome
from furuta_friction.compensation import COMPENSATIONS
from furuta_graph.settings import loop, rig_settings
from furuta_rig.rig import Rig
from furuta_rig.uncertainty import Uncertainty, changed_rig

# Bound on the friction's rate of the super-twisting correction that is recommended [V/s].
SUPER_TWISTING = 10.0
CONFIDENCE = 0.95
# Rank correlation below which a value hardly changes the residual.
SMALLEST_CORRELATION = 0.3
# Settings that are tried, by name.
CHOICES: dict[str, dict[str, dict[str, Any]]] = {
    **{name: {"friction_observer": {"compensation": name}} for name in COMPENSATIONS},
    "super_twisting": {
        "friction_observer": {"compensation": "none"},
        "controller": {"super_twisting": SUPER_TWISTING},
    },
}


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
    changes = uncertainty.draws(rigs, seed)
    plants = [changed_rig(rig, uncertainty.names, change) for change in changes]
    found = {name: list(batch(_loops(rig, plants, name), seconds)) for name in CHOICES}
    rows = [_row(name, outcomes) for name, outcomes in found.items()]
    standing = [row for row in rows if row.falls == 0]
    best = min(standing, key=lambda row: row.p95_rad).compensation if standing else None
    judged = found[best or "none"]
    falls = sum(each.fell for each in judged)
    limit = float(beta.ppf(CONFIDENCE, falls + 1, rigs - falls)) if falls < rigs else 1.0
    return RigCheck(rigs, rows, best, limit, influences(uncertainty.names, changes, judged))


def _loops(rig: Rig, plants: list[Rig], choice: str) -> Iterator[Loop]:
    """The loop of the rig's own control system with each plant."""
    settings = rig_settings(rig)
    for node, given in CHOICES[choice].items():
        settings[node] = settings[node] | given
    nominal = loop(settings)
    for seed, plant in enumerate(plants):
        of_plant = rig_settings(plant)
        of_plant["plant"]["seed"] = seed
        yield nominal._replace(plant=loop(of_plant).plant)


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
    residual = rankdata([np.inf if each.fell else each.phi_peak_to_peak_rad for each in outcomes])
    if np.ptp(residual) == 0.0:
        return {}
    found = {}
    for name, change in zip(names, changes.T, strict=True):
        if np.ptp(change) > 0.0:
            found[name] = float(np.corrcoef(rankdata(change), residual)[0, 1])
    strong = {n: each for n, each in found.items() if abs(each) >= SMALLEST_CORRELATION}
    return dict(sorted(strong.items(), key=lambda item: -abs(item[1])))
