"""Output error by multiple shooting: each stretch of a recording run freely, all compared at once.

A recording is cut into stretches. One stretch over the whole of it is the free run, the hardest
test of a model; short ones tame the unstable equilibrium and long horizons. The state at the
start of a stretch is unknown too: it is solved for within the residuals (variable projection), so
the optimiser sees the model's unknowns alone.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_identification.regression.speeds import with_speeds
from furuta_identification.shooting.prediction import predict
from furuta_identification.shooting.unknowns import Guess
from furuta_model.compiled import compiled
from furuta_model.friction.lugre import bristle_after, highest_level
from furuta_model.friction.parameters import LuGre
from furuta_model.state import BRISTLE, PHI, PHI_DOT, PLANT_STATES, RIGID_STATES, THETA, THETA_DOT
from furuta_recordings.recording import Recording

# Rounds of solving for the initial states each time the model changes.
ROUNDS = 2
# The same for predictions, which may begin far off.
PATIENT = 8
# Speed [rad/s] at the start of a free run from which it does not start from rest.
MOVING = 0.3
# Relative size of the steps by which slopes are taken.
STEP = 1e-6
# Largest step of an initial state [rad, rad/s] by which slopes are taken.
LOCAL_STEP = 1e-5
# Speeds are not compared this many lags after the start of a stretch, while the lag is unknown.
UNSETTLED = 2.0
# How many sizes of its noise a state at a start may be off by: it is measured with the very noise
# that is fitted next, so that measurement must hardly count.
LOOSE = 30.0
# Friction [V] that the bristle may carry at the start of a stretch where none is known yet.
SMALLEST_LEVEL = 0.01


class Stretches(NamedTuple):
    """A recording with the starts (s,) of its stretches and each start's measured state (s, 5).

    ``spread`` (s, 5) is how well that state is known; 0 where it is not solved for.
    ``scale`` (4,) is the size of a channel's residual that counts as one.
    """

    recording: Recording
    starts: np.ndarray
    measured: np.ndarray
    spread: np.ndarray
    scale: np.ndarray

    @property
    def segment(self) -> np.ndarray:
        """The stretch that each sample belongs to (n,)."""
        return np.searchsorted(self.starts, np.arange(len(self.recording.time)), "right") - 1


def stretches(recording: Recording, window: float, noise: np.ndarray, guess: Guess) -> Stretches:
    """Cut a recording every ``window`` [s] (infinite: not at all).

    The state at each start is what a line through the next samples says. A free run from rest
    keeps it; one that starts in motion, and shorter stretches, may correct it by as much as
    ``noise`` (4,) allows.
    """
    time = recording.time
    count = max(1, int((time[-1] - time[0]) // window)) if np.isfinite(window) else 1
    edges = time[0] + (time[-1] - time[0]) * np.arange(count) / count
    starts = np.searchsorted(time, edges - 1e-9)
    speeds = with_speeds(recording, guess["lag"])
    initial = np.zeros((count, PLANT_STATES))
    initial[:, :RIGID_STATES] = speeds.measured[starts]
    for row, start in zip(initial, starts, strict=True):
        _through_next_samples(row, recording, start)
    bristle = bristle_along(recording.time, speeds.measured[:, PHI_DOT].copy(), guess.friction)
    initial[:, BRISTLE] = bristle[starts]
    spread = np.zeros((count, PLANT_STATES))
    if count > 1 or np.max(np.abs(initial[0, [PHI_DOT, THETA_DOT]])) > MOVING:
        spread[:, :RIGID_STATES] = LOOSE * noise
        level = max(guess["coulomb"] + guess["alpha1"], SMALLEST_LEVEL)
        spread[:, BRISTLE] = 0.5 * level / guess["sigma0"]
    return Stretches(recording, starts, initial, spread, noise)


def _through_next_samples(row: np.ndarray, recording: Recording, start: int) -> None:
    """Angles at ``start`` from a parabola through the samples of the next 20 ms."""
    end = np.searchsorted(recording.time, recording.time[start] + 0.02)
    if end - start < 5:
        return
    t = recording.time[start:end] - recording.time[start]
    for angle in (PHI, THETA):
        row[angle] = np.polynomial.polynomial.polyfit(t, recording.measured[start:end, angle], 2)[0]


@compiled
def bristle_along(time: np.ndarray, v: np.ndarray, friction: LuGre) -> np.ndarray:
    """The bristle's deflection (n,) [rad] driven by the speed v (n,) [rad/s]."""
    z = np.zeros(len(time))
    limit = highest_level(friction) / friction.sigma0
    for k in range(len(time) - 1):
        mean = 0.5 * (v[k] + v[k + 1])
        end, _ = bristle_after(mean, 0.0, z[k], time[k + 1] - time[k], friction)
        z[k + 1] = min(max(end, -limit), limit)
    return z


class Shooting:
    """Residuals of stretches, and their slopes, as functions of the unknowns ``names``."""

    def __init__(self, parts: list[Stretches], names: list[str], guess: Guess) -> None:
        self.parts, self.names, self.guess = parts, names, guess
        self._initial = [part.measured.copy() for part in parts]
        self._weights = [_weights(part, guess) for part in parts]
        self._local: list[np.ndarray | None] = [None] * len(parts)
        self._solved: list[np.ndarray] = []
        self._solved_for: bytes = b""

    def residuals(self, vector: np.ndarray) -> np.ndarray:
        """All weighted residuals after the initial states are solved for."""
        self._solve(vector)
        return np.concatenate(self._solved)

    def slopes(self, vector: np.ndarray) -> np.ndarray:
        """∂residuals/∂vector, with what the initial states take up projected out."""
        self._solve(vector)
        blocks = []
        for i, part in enumerate(self.parts):
            base = self._solved[i]
            columns = np.empty((len(base), len(vector)))
            for j, value in enumerate(vector):
                step = STEP * max(1.0, abs(value))
                moved = vector.copy()
                moved[j] += step
                columns[:, j] = (self._residuals(i, moved, self._initial[i]) - base) / step
            if np.any(part.spread):
                local = self._local[i] = self._local_slopes(i, vector, base)
                columns = _projected(columns, local, part)
            blocks.append(columns)
        return np.concatenate(blocks)

    def predictions(self, vector: np.ndarray) -> list[np.ndarray]:
        """Each recording's predicted outputs (n, 4), in the recording's own zero."""
        self._solve(vector, PATIENT)
        return [self._predicted(i, vector, self._initial[i]) for i in range(len(self.parts))]

    def _predicted(self, i: int, vector: np.ndarray, initial: np.ndarray) -> np.ndarray:
        part = self.parts[i]
        guess = self.guess.changed(self.names, vector)
        turned = initial.copy()
        turned[:, THETA] += guess["zero"]
        predicted = predict(
            part.recording,
            part.starts,
            turned,
            guess.model,
            guess["delay"],
            guess["lag"],
        )
        predicted[:, THETA] -= guess["zero"]
        return predicted

    def _residuals(self, i: int, vector: np.ndarray, initial: np.ndarray) -> np.ndarray:
        """Weighted residuals (4n + 5s,) of one recording: outputs, then initial states."""
        part = self.parts[i]
        residuals = self.weighted(i, part.recording.measured - self._predicted(i, vector, initial))
        known = part.spread > 0.0
        prior = np.where(known, (part.measured - initial) / np.where(known, part.spread, 1.0), 0.0)
        residuals[-prior.size :] = prior.ravel()
        return residuals

    def weighted(self, i: int, error: np.ndarray) -> np.ndarray:
        """Residuals (4n + 5s,) of the outputs' ``error`` (n, 4), those of initial states zero."""
        weights = self._weights[i]
        outputs = np.where(weights > 0.0, error, 0.0) * weights
        return np.append(outputs.ravel(), np.zeros(self.parts[i].measured.size))

    def _local_slopes(self, i: int, vector: np.ndarray, base: np.ndarray) -> np.ndarray:
        """∂residuals/∂initial state (4n + 5s, 5): every stretch moves at once, each its own."""
        part = self.parts[i]
        columns = np.empty((len(base), PLANT_STATES))
        for state in range(PLANT_STATES):
            step = min(LOCAL_STEP, 1e-3 * part.spread[0, state])
            moved = self._initial[i].copy()
            moved[:, state] += step
            columns[:, state] = (self._residuals(i, vector, moved) - base) / step
        return columns

    def _solve(self, vector: np.ndarray, rounds: int = ROUNDS) -> None:
        """Gauss-Newton for the initial states of all stretches, warm from the last ones.

        With the slopes last taken: these hardly change from one model to the next.
        """
        if vector.tobytes() == self._solved_for and rounds == ROUNDS:
            return
        self._solved_for = vector.tobytes()
        self._solved = [self._solve_part(i, vector, rounds) for i in range(len(self.parts))]

    def _solve_part(self, i: int, vector: np.ndarray, rounds: int) -> np.ndarray:
        """Solve for the initial states of one recording; its residuals there.

        A stretch that a step makes worse stays where it was: some are chaotic.
        """
        part, base = self.parts[i], self._residuals(i, vector, self._initial[i])
        if not np.any(part.spread):
            return base
        for _ in range(rounds):
            local = self._local[i]
            if local is None:
                local = self._local[i] = self._local_slopes(i, vector, base)
            tried = self._initial[i] - _local_steps(local, base, part)
            after = self._residuals(i, vector, tried)
            worse = ~(_sizes(after, part) <= _sizes(base, part))
            if np.any(worse):
                tried[worse] = self._initial[i][worse]
                after = self._residuals(i, vector, tried)
            self._initial[i], base = tried, after
        return base


def _weights(part: Stretches, guess: Guess) -> np.ndarray:
    """One over the scale where something was measured, 0 elsewhere and where the lag unsettles."""
    weights = np.where(np.isfinite(part.recording.measured), 1.0 / part.scale, 0.0)
    since = part.recording.time - part.recording.time[part.starts[part.segment]]
    if len(part.starts) > 1:
        unsettled = since < UNSETTLED * guess["lag"]
        weights[unsettled, PHI_DOT] = weights[unsettled, THETA_DOT] = 0.0
    return weights


def _rows(part: Stretches) -> list[np.ndarray]:
    """The rows of each stretch in a residual vector."""
    n = len(part.recording.time)
    bounds = np.append(part.starts, n)
    own = 4 * n + 5 * np.arange(len(part.starts))
    return [
        np.append(np.arange(4 * bounds[s], 4 * bounds[s + 1]), np.arange(own[s], own[s] + 5))
        for s in range(len(part.starts))
    ]


def _sizes(residuals: np.ndarray, part: Stretches) -> np.ndarray:
    """Sum of squares of each stretch (s,)."""
    outputs = 4 * len(part.recording.time)
    squares = residuals**2
    sizes: np.ndarray = np.add.reduceat(squares[:outputs], 4 * part.starts)
    return sizes + squares[outputs:].reshape(len(part.starts), -1).sum(axis=1)


def _local_steps(local: np.ndarray, base: np.ndarray, part: Stretches) -> np.ndarray:
    steps = np.zeros((len(part.starts), PLANT_STATES))
    for step, rows in zip(steps, _rows(part), strict=True):
        step[:] = np.linalg.lstsq(local[rows], base[rows], rcond=None)[0]
    return steps


def _projected(columns: np.ndarray, local: np.ndarray, part: Stretches) -> np.ndarray:
    """``columns`` less what each stretch's initial state can take up."""
    result = columns.copy()
    for rows in _rows(part):
        basis, _ = np.linalg.qr(local[rows])
        result[rows] -= basis @ (basis.T @ columns[rows])
    return result
