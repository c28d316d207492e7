"""Covariance from the scatter between blocks of time, and whether slopes suffice for it."""

import itertools

import numpy as np
from scipy.special import stdtrit

from furuta_identification.shooting.optimisation import Optimum
from furuta_identification.shooting.shooting import Shooting
from furuta_identification.shooting.unknowns import BODY, prior_information

# Length [s] of a block, within which residuals may be correlated in any way.
BLOCK = 0.5
# Part of a standard error over which the residuals must be linear, and largest error of the
# prediction from the slopes, as a part of it. Ordinary fits have 0.01 to 0.5, chaotic ones more
# than 1.6.
LINEAR_PART, LARGEST_ERROR = 0.1, 1.0


def block_covariance(
    shooting: Shooting, slopes: np.ndarray, residuals: np.ndarray, information: np.ndarray
) -> np.ndarray:
    """Covariance of the parameters by leaving out one block of time after the other.

    This is the cluster jackknife CR3 (MacKinnon, Nielsen and Webb 2023) with one Gauss-Newton step
    per block. With few blocks a sandwich estimate ignores how much each block has influenced the
    fit.
    """
    covariance = np.zeros_like(information)
    blocks = _blocks(shooting)
    for rows in blocks:
        rest = np.linalg.pinv(information - slopes[rows].T @ slopes[rows])
        shift = rest @ (slopes[rows].T @ residuals[rows])
        covariance += np.outer(shift, shift)
    count = len(blocks)
    # Student's factor: two standard errors shall cover 95 % even with few blocks.
    factor = float(stdtrit(max(count - 1, 1), 0.975) / stdtrit(np.inf, 0.975))
    return covariance * factor**2 * (count - 1) / count


def _blocks(shooting: Shooting) -> list[slice]:
    """The rows of each block in the residuals of all recordings."""
    blocks, first = [], 0
    for part in shooting.parts:
        time = part.recording.time
        edges = np.searchsorted(time, np.arange(time[0], time[-1], BLOCK))
        blocks += [
            slice(first + 4 * start, first + 4 * end)
            for start, end in itertools.pairwise([*edges, len(time)])
        ]
        first += 4 * len(time) + part.measured.size
    return blocks


def is_linear(optimum: Optimum) -> bool:
    """Whether the residuals change linearly within a tenth of a standard error of each inertia.

    Those of a pendulum that turns over the top, or nearly, in a free run do not: their sum of
    squares has many minima, and each of them looks certain.
    """
    shooting, vector = optimum.shooting, optimum.vector
    slopes, residuals = shooting.slopes(vector), shooting.residuals(vector)
    information = slopes.T @ slopes + prior_information(shooting.names)
    covariance = block_covariance(shooting, slopes, residuals, information)
    for name in BODY:
        index = shooting.names.index(name)
        step = LINEAR_PART * covariance[:, index] / np.sqrt(covariance[index, index])
        predicted = slopes @ step
        error = shooting.residuals(vector + step) - residuals - predicted
        if np.linalg.norm(error) > LARGEST_ERROR * np.linalg.norm(predicted):
            return False
    return True
