"""Covariance of the fitted parameters: scatter between blocks of time, and what it does not show.

What it does not show are the priors, torque that varies with the arm's angle, values that had to be
assumed, and differences between recordings.
"""

import itertools

import numpy as np
from scipy.special import stdtrit

from furuta.identification.errors import jackknife, noise_of
from furuta.identification.regression.speeds import turns_one_way
from furuta.identification.shooting.optimisation import Optimum
from furuta.identification.shooting.shooting import Shooting
from furuta.identification.shooting.unknowns import BODY, is_zero, prior_information
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
    shooting, vector = optimum.shooting, optimum.vector
    slopes, residuals = shooting.slopes(vector), shooting.residuals(vector)
    information = slopes.T @ slopes
    of_prior = prior_information(shooting.names)
    inverse = np.linalg.pinv(information + of_prior)
    gain = inverse @ slopes.T
    covariance = inverse @ of_prior @ inverse
    covariance += block_covariance(shooting, slopes, residuals, information + of_prior)
    if swinging:
        covariance += _wave_covariance(shooting, vector, residuals, gain)
    size, more = len(vector), len(assumed)
    covariance, information = np.pad(covariance, (0, more)), np.pad(information, (0, more))
    for index, (name, spread) in enumerate(assumed.items(), start=size):
        shift = np.zeros(size + more)
        shift[:size] = -gain @ _slope_in(shooting, vector, name, spread) * spread
        shift[index] = spread
        covariance += np.outer(shift, shift)
    return covariance, information


def _wave_covariance(
    shooting: Shooting, vector: np.ndarray, residuals: np.ndarray, gain: np.ndarray
) -> np.ndarray:
    """The effect of waves of the torque at their expected size; 0 if noise explains everything.

    Waves that are part of the model do not count. The others together are at least as large as the
    residuals beyond the sensors' noise.
    """
    excess = float(residuals @ residuals) - sum(
        len(part.recording.time) * float(np.sum((noise_of(part.recording) / part.scale) ** 2))
        for part in shooting.parts
    )
    turns = max(np.ptp(part.recording.measured[:, PHI]) for part in shooting.parts)
    if excess <= 0.0 or turns == 0.0:
        return np.zeros((len(vector), len(vector)))
    fitted = shooting.values.changed(shooting.names, vector).wave_orders
    waves = shooting.slopes_in_waves(vector, [order for order in ORDERS if order not in fitted])
    largest = max(part.recording.largest_command for part in shooting.parts)
    usual = USUAL_PART * largest / np.sqrt(waves.shape[1] / 2)
    size = max(usual, np.sqrt(excess / float(np.sum(waves**2))))
    shifts: np.ndarray = size * (gain @ waves)
    return shifts @ shifts.T


def _slope_in(shooting: Shooting, vector: np.ndarray, name: str, spread: float) -> np.ndarray:
    """∂residuals/∂(assumed value)."""
    step = 0.01 * spread
    values = shooting.values.changed([name], [shooting.values.coordinates[name] + step])
    changed = Shooting(shooting.parts, shooting.names, values)
    return (changed.residuals(vector) - shooting.residuals(vector)) / step


def difference_covariance(
    common: Optimum, own_fits: list[Optimum], assumed: dict[str, float]
) -> np.ndarray:
    """Covariance of the differences between the recordings' own fits and the common one.

    What exceeds a recording's own errors is a difference between recordings that the model does
    not describe: random effects as in DerSimonian and Laird (1986).
    """
    names = [*common.shooting.names, *assumed]
    covariance = np.zeros((len(names), len(names)))
    if len(own_fits) == 1:
        return covariance
    for fit in own_fits:
        one_way = all(turns_one_way(part.recording) for part in fit.shooting.parts)
        own, _ = covariance_and_information(fit, assumed, swinging=True)
        excess = np.zeros(len(names))
        for k, (name, value) in enumerate(zip(fit.names, fit.vector, strict=True)):
            if is_zero(name) or (one_way and name in ("coulomb", "asymmetry")):
                continue
            difference = value - common.values.coordinates[name]
            size = np.sqrt(max(0.0, difference**2 - own[k, k]))
            excess[names.index(name)] = np.sign(difference) * size
        covariance += np.outer(excess, excess) / len(own_fits)
    return covariance


def block_covariance(
    shooting: Shooting, slopes: np.ndarray, residuals: np.ndarray, information: np.ndarray
) -> np.ndarray:
    """Covariance of the parameters by leaving out one block of time after the other."""
    rows = blocks_of(shooting)
    blocks = np.array([slopes[block].T @ slopes[block] for block in rows])
    scores = np.array([slopes[block].T @ residuals[block] for block in rows])
    # Student's factor: two standard errors shall cover 95 % even with few blocks.
    factor = float(stdtrit(max(len(rows) - 1, 1), 0.975) / stdtrit(np.inf, 0.975))
    return factor**2 * jackknife(information, blocks, scores)


def blocks_of(shooting: Shooting) -> list[slice]:
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
