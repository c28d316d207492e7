"""Whether values are distinguishable from 0, by what separate blocks of time say of them.

What is left of a fit is no white noise. Effects are therefore judged by their covariance over
blocks (Hotelling 1931), not by the decrease of the squares.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import fdtrc

from furuta.identification.least_squares import Fit
from furuta.identification.unknowns import Key


def significance(values: np.ndarray, covered: np.ndarray, blocks: int) -> float:
    """Probability by chance that values (k,) of such a covariance are as far from 0 (Hotelling)."""
    distance = float(values @ np.linalg.pinv(covered) @ values)
    k = len(values)
    if blocks <= k:
        return 1.0
    return float(fdtrc(k, blocks - k, distance / k * (blocks - k) / (blocks - 1)))


def chance_of(best: Fit, group: Sequence[Key], covered: np.ndarray | None = None) -> float:
    """Probability by chance that unknowns of a fit are as far from 0 as they are."""
    rows = [best.unknowns.keys.index(key) for key in group]
    values = best.unknowns.vector(best.values)[rows] / best.unknowns.all("size")[rows]
    covered = best.covariance if covered is None else covered
    return significance(values, covered[np.ix_(rows, rows)], best.segments)
