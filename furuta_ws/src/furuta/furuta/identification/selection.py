"""Which effects data support: each is tested by what separate blocks of time say of it.

What is left of a fit is no white noise. Effects are therefore judged by their covariance over
blocks (Hotelling 1931), not by the decrease of the squares.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import fdtrc

from furuta.identification.errors import inverse, jackknife
from furuta.identification.least_squares import Fit, Linearised
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


def tested(
    about: Linearised, known: Sequence[int], groups: Sequence[Sequence[int]]
) -> tuple[np.ndarray, np.ndarray]:
    """How much squares each group of further unknowns would explain, and whether by chance.

    ``known`` are the rows of what is fitted already. Returns the probabilities by chance (g,) and
    the decreases of the squares (g,), by one Gauss-Newton step and its covariance by blocks.
    """
    chances, gains = [], []
    for group in groups:
        rows, last = [*known, *group], len(group)
        information = about.information[np.ix_(rows, rows)]
        inverted = inverse(information)
        blocks, step = about.blocks[:, rows][:, :, rows], inverted @ about.gradient[rows]
        covered = jackknife(information, blocks, about.scores[:, rows] - blocks @ step)
        covered += (inverted * about.scatter[rows]) @ inverted
        chances.append(significance(step[-last:], covered[-last:, -last:], len(blocks)))
        gains.append(step[-last:] @ inverse(inverted[-last:, -last:]) @ step[-last:])
    return np.array(chances), np.array(gains)
