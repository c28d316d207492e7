"""Output-error residuals by multiple shooting, with the initial states projected out.

A recording is cut into segments, and the model is simulated along each. One segment over the whole
recording is the free run, the hardest test of a model. Short segments cope with the unstable
equilibrium and with long recordings. The state at the start of a segment is unknown too. It is
solved for within the residuals (variable projection), so that the optimiser sees only the model's
parameters.
"""

import numpy as np

from furuta.identification.shooting.prediction import predict
from furuta.identification.shooting.segments import (
    Segments,
    gauss_newton_steps,
    sums_of_squares,
    without_initial_states,
)
from furuta.identification.shooting.unknowns import ParameterValues, wave_names
from furuta_model.state import PHI_DOT, PLANT_STATES, THETA, THETA_DOT

# Gauss-Newton steps for the initial states after each change of the parameters, and for
# predictions, whose first initial states may be far off.
STEPS = 2
PREDICTION_STEPS = 8
# Relative step of the parameters for finite differences.
RELATIVE_STEP = 1e-6
# Largest step of an initial state [rad, rad/s] for finite differences.
LARGEST_STATE_STEP = 1e-5
# While the lag is fitted, speeds do not count this many lags after the start of a segment.
SETTLING_LAGS = 2.0


class Shooting:
    """Residuals of segments, and their slopes, as functions of the unknowns ``names``."""

    def __init__(self, parts: list[Segments], names: list[str], values: ParameterValues) -> None:
        self.parts, self.names, self.values = parts, names, values
        self._initial = [part.measured.copy() for part in parts]
        self._weights = [_weights(part, values) for part in parts]
        # Slopes of the residuals in the initial states, and residuals at the solved states.
        self._state_slopes: list[np.ndarray | None] = [None] * len(parts)
        self._solved: list[np.ndarray] = []
        self._solved_for: bytes | None = None

    def residuals(self, vector: np.ndarray) -> np.ndarray:
        """All weighted residuals after the initial states are solved for."""
        self._solve(vector)
        return np.concatenate(self._solved)

    def slopes_in_waves(self, vector: np.ndarray, orders: list[int]) -> np.ndarray:
        """∂residuals/∂amplitude of the cosine and the sine wave of each order (n, 2k) [1/V]."""
        added = [name for order in orders for name in wave_names(order)]
        nothing = np.zeros(len(added))
        wider = Shooting(self.parts, [*self.names, *added], self.values.changed(added, nothing))
        wider._initial = [initial.copy() for initial in self._initial]
        return wider.slopes(np.append(vector, nothing), first=len(vector))

    def slopes(self, vector: np.ndarray, first: int = 0) -> np.ndarray:
        """∂residuals/∂vector, from element ``first`` on.

        The part that the initial states can explain is left out.
        """
        self._solve(vector)
        return np.concatenate([self._part_slopes(i, vector, first) for i in range(len(self.parts))])

    def _part_slopes(self, i: int, vector: np.ndarray, first: int) -> np.ndarray:
        """Slopes of one recording's residuals, by finite differences."""
        base = self._solved[i]
        columns = np.empty((len(base), len(vector) - first))
        for j in range(first, len(vector)):
            step = RELATIVE_STEP * max(1.0, abs(vector[j]))
            changed = vector.copy()
            changed[j] += step
            columns[:, j - first] = (self._residuals(i, changed, self._initial[i]) - base) / step
        if not np.any(self.parts[i].spread):
            return columns
        slopes = self._state_slopes[i] = self._slopes_in_initial_states(i, vector, base)
        return without_initial_states(columns, slopes, self.parts[i])

    def predictions(self, vector: np.ndarray) -> list[np.ndarray]:
        """Predicted outputs (n, 4) of each recording, with the recording's own zero."""
        self._solve(vector, PREDICTION_STEPS)
        return [self._predicted(i, vector, self._initial[i]) for i in range(len(self.parts))]

    def _predicted(self, i: int, vector: np.ndarray, initial: np.ndarray) -> np.ndarray:
        part = self.parts[i]
        values = self.values.changed(self.names, vector)
        upright = initial.copy()
        zero = values.zero(part.recording.number)
        upright[:, THETA] += zero
        predicted = predict(part.recording, part.starts, upright, values.model)
        predicted[:, THETA] -= zero
        return predicted

    def _residuals(self, i: int, vector: np.ndarray, initial: np.ndarray) -> np.ndarray:
        """Weighted residuals (4n + 5s,) of one recording: outputs, then initial states."""
        part = self.parts[i]
        error = part.recording.measured - self._predicted(i, vector, initial)
        weights = self._weights[i]
        outputs = np.where(weights > 0.0, error, 0.0) * weights
        known = part.spread > 0.0
        prior = np.where(known, (part.measured - initial) / np.where(known, part.spread, 1.0), 0.0)
        return np.append(outputs.ravel(), prior.ravel())

    def _slopes_in_initial_states(self, i: int, vector: np.ndarray, base: np.ndarray) -> np.ndarray:
        """∂residuals/∂initial state (4n + 5s, 5): all segments change at once, independently."""
        part = self.parts[i]
        columns = np.empty((len(base), PLANT_STATES))
        for state in range(PLANT_STATES):
            step = min(LARGEST_STATE_STEP, 1e-3 * part.spread[0, state])
            changed = self._initial[i].copy()
            changed[:, state] += step
            columns[:, state] = (self._residuals(i, vector, changed) - base) / step
        return columns

    def _solve(self, vector: np.ndarray, steps: int = STEPS) -> None:
        """Solve for all initial states by Gauss-Newton steps, starting from the last ones.

        The slopes are those computed last: they hardly differ between similar models.
        """
        if vector.tobytes() == self._solved_for and steps == STEPS:
            return
        self._solved_for = vector.tobytes()
        self._solved = [self._solve_part(i, vector, steps) for i in range(len(self.parts))]

    def _solve_part(self, i: int, vector: np.ndarray, steps: int) -> np.ndarray:
        """Solve for the initial states of one recording; returns the residuals there."""
        base = self._residuals(i, vector, self._initial[i])
        if not np.any(self.parts[i].spread):
            return base
        for _ in range(steps):
            base = self._improved(i, vector, base)
        return base

    def _improved(self, i: int, vector: np.ndarray, base: np.ndarray) -> np.ndarray:
        """One step for one recording; a segment that it makes worse (some are chaotic) stays."""
        part, slopes = self.parts[i], self._state_slopes[i]
        if slopes is None:
            slopes = self._state_slopes[i] = self._slopes_in_initial_states(i, vector, base)
        candidate = self._initial[i] - gauss_newton_steps(slopes, base, part)
        after = self._residuals(i, vector, candidate)
        worse = ~(sums_of_squares(after, part) <= sums_of_squares(base, part))
        if np.any(worse):
            candidate[worse] = self._initial[i][worse]
            after = self._residuals(i, vector, candidate)
        self._initial[i] = candidate
        return after


def _weights(part: Segments, values: ParameterValues) -> np.ndarray:
    """One over the scale (n, 4); 0 for missing values and for speeds that have not settled yet."""
    weights = np.where(np.isfinite(part.recording.measured), 1.0 / part.scale, 0.0)
    since = part.recording.time - part.recording.time[part.starts[part.index_of_samples]]
    if len(part.starts) > 1:
        unsettled = since < SETTLING_LAGS * values["lag"]
        weights[unsettled, PHI_DOT] = weights[unsettled, THETA_DOT] = 0.0
    return weights
