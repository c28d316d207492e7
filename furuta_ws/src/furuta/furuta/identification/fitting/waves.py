r"""Which waves of the motor's torque over the arm's turn the data contain.

Each wave changes the residuals of short segments in proportion to its amplitude. Waves are added
one by one. The next one is the wave that most lowers the error of prediction: amplitudes from all
recordings but one predict that one, or, for a single recording, from all parts but one. A sensor
that errs with the angle, or a resonance, looks like a wave in one recording but not in another at
another speed. The wave must also lower the criterion of Schwarz (1978),

.. math::
    n \ln S + k \ln n,

with the sum of squares S, k = 3 for its two amplitudes and its order, and n the effective number
of samples: residuals that are correlated in time count as fewer. What a change of the other
unknowns could explain too does not count.
"""

from typing import NamedTuple

import numpy as np

from furuta.identification.regression.windows import correlation_length
from furuta.identification.shooting.optimisation import Optimum
from furuta.identification.shooting.segments import cut_into_segments
from furuta.identification.shooting.shooting import Shooting
from furuta_model.state import PHI, PHI_DOT, RIGID_STATES

# Waves per turn that are tried, and most waves.
HIGHEST_ORDER, MOST_WAVES = 60, 6
# Turns of the arm, in one of the recordings, that show waves. Over less than a turn neighbouring
# orders look alike; one of them stands for all.
FEWEST_TURNS = 0.25
# Length of the segments [s], and parts of a single recording that predict each other.
SEGMENT, PARTS = 0.5, 4
# Parameters of a wave: two amplitudes and its order.
PER_WAVE = 3


class _Problem(NamedTuple):
    """Products (f, 2k + 1, 2k + 1) of the waves' slopes and the residuals in each fold; samples."""

    products: np.ndarray
    samples: float


def significant_orders(optimum: Optimum) -> list[int]:
    """Orders of the waves that the data contain beyond those of the model."""
    recordings, values = optimum.recordings, optimum.values
    turns = max(float(np.ptp(r.measured[:, PHI])) for r in recordings) / (2.0 * np.pi)
    if turns < FEWEST_TURNS:
        return []
    parts = [cut_into_segments(r, SEGMENT, optimum.scale, values) for r in recordings]
    shooting = Shooting(parts, optimum.names, values)
    orders = [n for n in range(2, HIGHEST_ORDER + 1) if n not in values.wave_orders]
    problem = _problem(shooting, optimum.vector, orders)
    return sorted(orders[k] for k in _selected(problem))


def _problem(shooting: Shooting, vector: np.ndarray, orders: list[int]) -> _Problem:
    others, residuals = shooting.slopes(vector), shooting.residuals(vector)
    waves = shooting.slopes_in_waves(vector, orders)
    folds, products = _folds(shooting), []
    for fold in np.unique(folds):
        here = folds == fold
        basis, _ = np.linalg.qr(others[here])
        both = np.column_stack((waves[here], residuals[here]))
        both -= basis @ (basis.T @ both)
        residuals[here] = both[:, -1]
        products.append(both.T @ both)
    return _Problem(np.array(products), _effective_count(shooting, residuals))


def _folds(shooting: Shooting) -> np.ndarray:
    """The fold of each row: its recording or, if there is one only, its part of it."""
    folds = []
    several = len({part.recording.number for part in shooting.parts}) > 1
    for index, part in enumerate(shooting.parts):
        n = len(part.recording.time)
        fold = np.full(n, part.recording.number if several else index)
        if len(shooting.parts) == 1:
            fold = PARTS * part.index_of_samples // len(part.starts)
        of_states = fold[part.starts]
        folds += [np.repeat(fold, RIGID_STATES), np.repeat(of_states, part.measured.shape[1])]
    return np.concatenate(folds)


def _selected(problem: _Problem) -> list[int]:
    """Indices of the waves, the one that explains most first."""
    chosen: list[int] = []
    error = criterion = np.inf
    total = np.sum(problem.products, axis=0)
    candidates = range(len(total) // 2)
    while len(chosen) <= MOST_WAVES:
        sum_of_squares = _error(chosen, total, total)
        penalty = PER_WAVE * len(chosen) * np.log(problem.samples)
        now = problem.samples * np.log(sum_of_squares) + penalty
        held_out = _held_out_error(problem, chosen)
        if now >= criterion or held_out >= error:
            return chosen[:-1]
        error, criterion = held_out, now
        rest = [k for k in candidates if k not in chosen]
        chosen.append(min(rest, key=lambda k: _held_out_error(problem, [*chosen, k])))
    return chosen[:MOST_WAVES]


def _held_out_error(problem: _Problem, chosen: list[int]) -> float:
    """Sum of squares of every fold with amplitudes from the other folds."""
    total = np.sum(problem.products, axis=0)
    return sum(_error(chosen, total - fold, fold) for fold in problem.products)


def _error(chosen: list[int], fitted: np.ndarray, predicted: np.ndarray) -> float:
    """Sum of squares that waves leave in some rows, with amplitudes from the ``fitted`` rows.

    Of both only the products are needed, which are as small as the waves are few.
    """
    columns = [2 * k + part for k in chosen for part in (0, 1)]
    square, side = fitted[np.ix_(columns, columns)], fitted[columns, -1]
    weights = np.zeros(len(fitted))
    weights[columns] = np.linalg.lstsq(square, side, rcond=None)[0]
    weights[-1] = -1.0
    return float(weights @ predicted @ weights)


def _effective_count(shooting: Shooting, residuals: np.ndarray) -> float:
    """Number of independent samples that tell as much as the correlated ones."""
    count, first = 0.0, 0
    for part in shooting.parts:
        n = len(part.recording.time)
        series = residuals[first : first + RIGID_STATES * n].reshape(n, RIGID_STATES)
        count += n / correlation_length(series[:, PHI_DOT])
        first += RIGID_STATES * n + part.measured.size
    return count
