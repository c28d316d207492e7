"""How well the unknowns are known: noise, what the model leaves, and what it had to assume."""

from __future__ import annotations

import itertools

import numpy as np
from scipy.special import stdtrit

from furuta_identification.shooting.shooting import Shooting
from furuta_identification.shooting.unknowns import BY_NAME
from furuta_identification.uncertainty.sensing import noise_of, seen_again, sensor_of
from furuta_model.state import PHI

# Length [s] within which residuals may go together in any way.
BLOCK = 0.5
# Synthetic recordings from which the effect of the sensors' errors is taken.
REPLICATES = 200
# Waves a turn that an unmodelled torque may have.
ORDERS = range(2, 43)
# Size of them all, as part of the largest command, that a motor's torque has as a rule, where the
# residuals show that the model lacks something: a short way of the arm hides them.
RIPPLE = 0.01
# Size [V] of the waves by which slopes are taken.
WAVE = 1e-4


def prior(names: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Prior mean and spread of the unknowns, as the optimiser has them."""
    return (
        np.array([BY_NAME[name].mean for name in names]),
        np.array([BY_NAME[name].spread for name in names]),
    )


def uncertainty(
    shooting: Shooting, vector: np.ndarray, held: dict[str, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Covariance of the unknowns, then of those ``held`` (value: its spread); and information.

    The information is what the data alone say. The covariance has the prior's part and three
    more: of stretches, what the sensors' errors make of the fit, of free runs, what each block of
    time does; what residuals beyond the sensors' noise could have shifted, were they a torque that
    waves over the arm's turn; and what an assumed value could have, were it wrong by its spread.
    """
    slopes, residuals = shooting.slopes(vector), shooting.residuals(vector)
    information = slopes.T @ slopes
    _, spread = prior(shooting.names)
    own = np.diag(1.0 / spread**2)
    inverse = np.linalg.pinv(information + own)
    gain = inverse @ slopes.T
    covariance = inverse @ own @ inverse
    if all(len(part.starts) > 1 for part in shooting.parts):
        covariance += _by_sensors(shooting, vector, residuals, gain)
    else:
        covariance += _by_blocks(shooting, slopes, residuals, information + own)
        waves = _wave_slopes(shooting, vector, residuals)
        if waves is not None:
            shifts = gain @ waves
            covariance += shifts @ shifts.T
    return _with_held(shooting, vector, held, covariance, information, gain)


def _by_blocks(
    shooting: Shooting, slopes: np.ndarray, residuals: np.ndarray, whole: np.ndarray
) -> np.ndarray:
    """Covariance by leaving out each block of time in turn, within which all may go together.

    The cluster jackknife CR3 (MacKinnon, Nielsen and Webb 2023), one Gauss-Newton step each: with
    few blocks a sandwich forgets how much each has drawn the fit to itself.
    """
    covariance = np.zeros_like(whole)
    first = count = 0
    for part in shooting.parts:
        time = part.recording.time
        edges = np.searchsorted(time, np.arange(time[0], time[-1], BLOCK))
        for begin, end in itertools.pairwise([*edges, len(time)]):
            rows = slice(first + 4 * begin, first + 4 * end)
            rest = np.linalg.pinv(whole - slopes[rows].T @ slopes[rows])
            shift = rest @ (slopes[rows].T @ residuals[rows])
            covariance += np.outer(shift, shift)
            count += 1
        first += 4 * len(time) + part.measured.size
    # So that two standard errors hold 95 % although the scatter is of a few blocks alone.
    few = float(stdtrit(max(count - 1, 1), 0.975) / stdtrit(np.inf, 0.975))
    return covariance * few**2 * (count - 1) / count


def _by_sensors(
    shooting: Shooting, vector: np.ndarray, residuals: np.ndarray, gain: np.ndarray
) -> np.ndarray:
    """Covariance by what the sensors would have made of the model's own motion, again and again.

    A parametric bootstrap (Efron and Tibshirani 1993, ch. 6.5) by linear shifts. An encoder's
    counts are off in the same way in each period of a periodic motion, which no scatter among the
    residuals shows: the fit has taken it up.
    """
    rng = np.random.default_rng(0)
    predicted = shooting.predictions(vector)
    sensors = [sensor_of(part.recording) for part in shooting.parts]
    shifts, sizes = [], []
    for _ in range(REPLICATES):
        error = np.concatenate(
            [
                shooting.weighted(i, seen_again(y, sensor, rng) - y)
                for i, (y, sensor) in enumerate(zip(predicted, sensors, strict=True))
            ]
        )
        shifts.append(gain @ error)
        sizes.append(np.median(error[error != 0.0] ** 2))
    # By medians: one stretch that the model lost is no measure of the others.
    beyond = max(1.0, float(np.median(residuals[residuals != 0.0] ** 2) / np.median(sizes)))
    covariance: np.ndarray = beyond * np.cov(np.array(shifts).T)
    return covariance


def _wave_slopes(
    shooting: Shooting, vector: np.ndarray, residuals: np.ndarray
) -> np.ndarray | None:
    """What waves of the torque add to the residuals, as large as they may be; or None.

    They are at least as large as what the model leaves beyond noise.
    """
    noise = sum(
        len(part.recording.time) * float(np.sum((noise_of(part.recording) / part.scale) ** 2))
        for part in shooting.parts
    )
    left = float(residuals @ residuals) - noise
    turns = max(np.ptp(part.recording.measured[:, PHI]) for part in shooting.parts)
    if left <= 0.0 or turns == 0.0:
        return None
    names = ["ripple_order", "ripple_cos", "ripple_sin"]
    columns = []
    for order in ORDERS:
        for wave in ((WAVE, 0.0), (0.0, WAVE)):
            guess = shooting.guess.changed(names, (order, *wave))
            moved = Shooting(shooting.parts, _without(shooting.names, names), guess)
            values = _of(shooting, vector, moved.names)
            columns.append(
                (moved.residuals(values) - _reference(shooting, vector, residuals)) / WAVE
            )
    waves = np.array(columns).T
    largest = max(float(np.max(np.abs(part.recording.command))) for part in shooting.parts)
    expected = RIPPLE * largest / np.sqrt(waves.shape[1] / 2)
    size: float = max(expected, np.sqrt(left / float(np.sum(waves**2))))
    return size * waves


def _reference(shooting: Shooting, vector: np.ndarray, residuals: np.ndarray) -> np.ndarray:
    """Residuals without the fitted ripple, from which the waves' effects are counted."""
    if "ripple_cos" not in shooting.names:
        return residuals
    return shooting.residuals(
        np.array(
            [
                0.0 if name in ("ripple_cos", "ripple_sin") else value
                for name, value in zip(shooting.names, vector, strict=True)
            ]
        )
    )


def _without(names: list[str], taken: list[str]) -> list[str]:
    return [name for name in names if name not in taken]


def _of(shooting: Shooting, vector: np.ndarray, names: list[str]) -> np.ndarray:
    return np.array([vector[shooting.names.index(name)] for name in names])


def _with_held(
    shooting: Shooting,
    vector: np.ndarray,
    held: dict[str, float],
    covariance: np.ndarray,
    information: np.ndarray,
    gain: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Both matrices enlarged by values that were assumed, and what they shift when wrong."""
    for name, spread in held.items():
        step = 0.01 * spread
        value = shooting.guess[name]
        moved = Shooting(
            shooting.parts, shooting.names, shooting.guess.changed([name], [value + step])
        )
        slope = (moved.residuals(vector) - shooting.residuals(vector)) / step
        shift = -gain @ slope * spread
        n = len(covariance)
        covariance = np.pad(covariance, ((0, 1), (0, 1)))
        information = np.pad(information, ((0, 1), (0, 1)))
        covariance[:n, :n] += np.outer(shift[:n], shift[:n])
        covariance[n, :n] = covariance[:n, n] = shift[:n] * spread
        covariance[n, n] = spread**2
        gain = np.vstack((gain, np.zeros(gain.shape[1])))
    return covariance, information
