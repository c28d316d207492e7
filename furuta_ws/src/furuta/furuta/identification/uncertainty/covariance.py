"""Covariance of the fitted parameters: scatter between blocks of time, and what it does not show.

What it does not show are the priors, waves of the torque that were not found, values that had to be
assumed, and differences between recordings.
"""

import itertools

import numpy as np

from furuta.identification.averaging import few
from furuta.identification.errors import inverse
from furuta.identification.fitting.waves import WAVES
from furuta.identification.least_squares import evaluated, residuals, solved
from furuta.identification.regression.speeds import turns_one_way
from furuta.identification.shooting.optimisation import Optimum
from furuta.identification.shooting.unknowns import BODY, LARGEST_LOG_CHANGE
from furuta.identification.unknowns import field_of

# Part of a standard error over which the residuals must be linear, and largest error of the
# prediction from the slopes, as a part of it. Ordinary fits have 0.01 to 0.5, chaotic ones more
# than 1.6.
LINEAR_PART, LARGEST_ERROR = 0.1, 1.0
# Steps of the first states before the residuals are compared.
STEPS = 2


def covariance_and_information(
    optimum: Optimum, assumed: dict[str, float], swinging: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Covariance of the unknowns, then of the ``assumed`` ones (name: spread); and information.

    The information is that of the data alone. The covariance is that by blocks of time, of a
    ``swinging`` pendulum over all waves of the torque that explain it about as well; and the effect
    of an error of the assumed values.
    """
    size, more = len(optimum.keys), len(assumed)
    if swinging:
        there = optimum.neighbourhood(WAVES)
        covariance = there.averaged(there.candidates(WAVES)).covariance
    else:
        best = optimum.in_blocks()
        covariance = few(best.segments - best.determined) * best.covariance
    wider = optimum.about(list(assumed))
    own, data = inverse(wider.information[:size, :size]), wider.blocks.sum(axis=0)
    covariance = np.pad(covariance, (0, more))
    information = np.pad(data[:size, :size], (0, more))
    for index, spread in enumerate(assumed.values(), start=size):
        shift = np.zeros(size + more)
        shift[:size] = -own @ data[:size, index] * spread
        shift[index] = spread
        covariance += np.outer(shift, shift)
    return covariance, information


def difference_covariance(
    common: Optimum, own_fits: list[Optimum], assumed: dict[str, float]
) -> np.ndarray:
    """Covariance of the differences between the recordings' own fits and the common one.

    What exceeds a recording's own errors is a difference between recordings that the model does
    not describe: random effects as in DerSimonian and Laird (1986).
    """
    keys = [*common.keys, *assumed]
    covariance = np.zeros((len(keys), len(keys)))
    if len(own_fits) == 1:
        return covariance
    for fit in own_fits:
        one_way = all(turns_one_way(recording) for recording in fit.recordings)
        own, _ = covariance_and_information(fit, assumed, swinging=True)
        excess = np.zeros(len(keys))
        for k, (key, value) in enumerate(zip(fit.keys, fit.vector, strict=True)):
            if field_of(key) == "zero" or (one_way and key in ("coulomb", "asymmetry")):
                continue
            difference = value - common.values.coordinates[key]
            size = np.sqrt(max(0.0, difference**2 - own[k, k]))
            excess[keys.index(key)] = np.sign(difference) * size
        covariance += np.outer(excess, excess) / len(own_fits)
    return covariance


def is_linear(optimum: Optimum) -> bool:
    """Whether the residuals change linearly within a tenth of a standard error of each inertia.

    Those of a pendulum that turns over the top, or nearly, in a free run do not: their sum of
    squares has many minima, and each of them looks certain.
    """
    best, problem = optimum.in_blocks(), optimum.problem._replace(robust=False)
    about, covariance, state = best.about, best.covariance, best.state
    at_optimum = residuals(problem, state.values, solved(problem, state, about))
    for name in BODY:
        index = optimum.keys.index(name)
        step = LINEAR_PART * covariance[:, index] / np.sqrt(covariance[index, index])
        if max(abs(step[optimum.keys.index(each)]) for each in BODY) > LARGEST_LOG_CHANGE:
            return False
        values = problem.unknowns.changed(state.values, optimum.vector + step)
        first = state.first - np.einsum("skp,p->sk", about.back, step) * problem.cut.spread
        predicted = about.columns @ step
        for s, (start, end) in enumerate(itertools.pairwise(problem.cut.bounds)):
            predicted[start:end] -= about.states[start:end] @ (about.back[s] @ step)
        for _ in range(STEPS):
            first = solved(problem, evaluated(problem, values, first), about)
        error = residuals(problem, values, first) - at_optimum + predicted
        if np.linalg.norm(error) > LARGEST_ERROR * np.linalg.norm(predicted):
            return False
    return True
