"""Whether a fit is linear enough for standard errors that are computed from slopes."""

from __future__ import annotations

import numpy as np

from furuta_identification.fitting.optimisation import Optimum
from furuta_identification.shooting.unknowns import BODY, prior_information
from furuta_identification.uncertainty.jackknife import block_covariance

# Part of a standard error over which the residuals must be linear, and largest error of the
# prediction from the slopes, as a part of it. Ordinary fits have 0.01 to 0.5, chaotic ones more
# than 1.6.
PART, LARGEST_ERROR = 0.1, 1.0


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
        step = PART * covariance[:, index] / np.sqrt(covariance[index, index])
        predicted = slopes @ step
        error = shooting.residuals(vector + step) - residuals - predicted
        if np.linalg.norm(error) > LARGEST_ERROR * np.linalg.norm(predicted):
            return False
    return True
