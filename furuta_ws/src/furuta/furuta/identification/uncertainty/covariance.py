"""Covariance of the fitted parameters: scatter between blocks of time, and what it does not show.

What it does not show are the priors, torque that varies with the arm's angle, values that had to be
assumed, and differences between recordings.
"""

import itertools

import numpy as np
from scipy.special import stdtrit

from furuta.identification.errors import jackknife, noise_of
from furuta.identification.least_squares import Linearised, evaluated, in_blocks, residuals, solved
from furuta.identification.regression.speeds import turns_one_way
from furuta.identification.shooting.optimisation import Optimum
from furuta.identification.shooting.unknowns import BODY, LARGEST_LOG_CHANGE, wave
from furuta.identification.unknowns import field_of
from furuta_model.state import PHI

# Waves per turn that unmodelled torque may have.
ORDERS = range(2, 43)
# Usual size of all waves together, as a part of the largest command. It applies where the
# residuals show that the model is incomplete; they need not show its size on a short travel.
USUAL_PART = 0.01
# Length [s] of a block, within which residuals may be correlated in any way.
BLOCK = 0.5
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

    The information is that of the data alone. The covariance is a sum:

    - the part of the prior;
    - the scatter between blocks of time (:func:`block_covariance`);
    - for a ``swinging`` pendulum, the effect of a torque that varies with the arm's angle;
    - the effect of an error of the assumed values.
    """
    size, more = len(optimum.keys), len(assumed)
    about = optimum.about()
    inverse = np.linalg.pinv(about.information)
    covariance = (inverse * about.scatter) @ inverse + block_covariance(optimum, about)
    if swinging:
        covariance += _wave_covariance(optimum, inverse)
    wider = optimum.about(list(assumed)).blocks.sum(axis=0)
    covariance = np.pad(covariance, (0, more))
    information = np.pad(wider[:size, :size], (0, more))
    for index, spread in enumerate(assumed.values(), start=size):
        shift = np.zeros(size + more)
        shift[:size] = -inverse @ wider[:size, index] * spread
        shift[index] = spread
        covariance += np.outer(shift, shift)
    return covariance, information


def _wave_covariance(optimum: Optimum, inverse: np.ndarray) -> np.ndarray:
    """The effect of waves of the torque at their expected size; 0 if noise explains everything.

    Waves that are part of the model do not count. The others together are at least as large as the
    residuals beyond the sensors' noise. ``inverse`` is that of the information of the unknowns.
    """
    squares, recordings = float(np.sum(optimum.fit.state.residuals**2)), optimum.recordings
    excess = squares - sum(
        len(recording.time) * float(np.sum((noise_of(recording) / optimum.scale) ** 2))
        for recording in recordings
    )
    turns = max(np.ptp(recording.measured[:, PHI]) for recording in recordings)
    if excess <= 0.0 or turns == 0.0:
        return np.zeros_like(inverse)
    orders = [order for order in ORDERS if order not in optimum.values.wave_orders]
    size, keys = len(optimum.keys), [key for order in orders for key in wave(order)]
    information = optimum.about(keys).blocks.sum(axis=0)
    largest = max(recording.largest_command for recording in recordings)
    usual = USUAL_PART * largest / np.sqrt(len(orders))
    effect = max(usual, np.sqrt(excess / float(np.trace(information[size:, size:]))))
    shifts: np.ndarray = effect * (inverse @ information[:size, size:])
    return shifts @ shifts.T


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


def block_covariance(optimum: Optimum, about: Linearised) -> np.ndarray:
    """Covariance of the parameters by leaving out one block of time after the other."""
    blocks = in_blocks(about, optimum.problem.cut, optimum.fit.state, BLOCK)
    # Student's factor: two standard errors shall cover 95 % even with few blocks.
    free = max(len(blocks.scores) - 1, 1)
    factor = float(stdtrit(free, 0.975) / stdtrit(np.inf, 0.975))
    return factor**2 * jackknife(about.information, blocks.blocks, blocks.scores)


def is_linear(optimum: Optimum) -> bool:
    """Whether the residuals change linearly within a tenth of a standard error of each inertia.

    Those of a pendulum that turns over the top, or nearly, in a free run do not: their sum of
    squares has many minima, and each of them looks certain.
    """
    about, problem, state = (
        optimum.about(),
        optimum.problem._replace(robust=False),
        optimum.fit.state,
    )
    covariance = block_covariance(optimum, about)
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
