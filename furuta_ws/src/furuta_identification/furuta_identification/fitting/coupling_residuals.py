"""Residuals and fits of an elastic coupling along recordings, see :mod:`.coupling`."""

from __future__ import annotations

from copy import copy
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from furuta_identification.shooting.elastic_prediction import predict_elastic
from furuta_identification.shooting.optimisation import noise_of
from furuta_identification.shooting.prediction import predict
from furuta_identification.shooting.segments import (
    cut_into_segments,
    gauss_newton_steps,
    segment_rows,
    sums_of_squares,
)
from furuta_identification.shooting.shooting import Shooting
from furuta_identification.shooting.unknowns import (
    ParameterValues,
    bounds,
    prior,
    prior_information,
)
from furuta_identification.uncertainty.covariance import block_scatter, blocks_of
from furuta_model.parts.coupling import Coupling
from furuta_model.state import RIGID_STATES, THETA
from furuta_recordings.recording import Recording

# Length of the segments [s], and parts that predict each other.
SEGMENT, PARTS = 0.5, 4
# Unknowns: logarithms of frequency [Hz] and damping ratio, share of the motor, gap [rad].
LOWEST = np.array([np.log(8.0), np.log(0.003), 0.04, 1e-5])
HIGHEST = np.array([np.log(400.0), np.log(0.6), 0.96, 0.2])
# Steps of the slopes at first, and smallest ones: a motion with impacts is rough.
STEPS, SMALLEST_STEPS = np.array([0.02, 0.2, 0.01, 1e-4]), np.array([1e-4, 1e-3, 1e-4, 1e-5])
# What the rigid model keeps while the coupling is fitted: their effect is far from linear.
FIXED = ("alpha1", "stribeck_velocity")
EVALUATIONS, ROUNDS, CONVERGED = 12, 4, 0.999


class ElasticFit(NamedTuple):
    """Vector of the unknowns, side of the sensors, residuals (n,) and their slopes (n, k)."""

    vector: np.ndarray
    side: str
    residuals: np.ndarray
    slopes: np.ndarray

    @property
    def size(self) -> float:
        """Sum of squares."""
        return float(self.residuals @ self.residuals)

    @property
    def coupling(self) -> Coupling:
        """The coupling."""
        return coupling_of(self.vector, self.side)


def coupling_of(vector: np.ndarray, side: str) -> Coupling:
    """The coupling of a vector of unknowns; without a gap it has three."""
    frequency, damping = map(float, np.exp(vector[:2]))
    gap = float(vector[3]) if len(vector) > 3 else 0.0
    return Coupling(frequency, damping, float(vector[2]), gap, sensors=side)


class CouplingResiduals:
    """Residuals of couplings along recordings, without what the rigid model could explain.

    That is, to first order, what other ``values`` or states at the starts of the segments explain.
    """

    def __init__(
        self,
        recordings: list[Recording],
        names: list[str],
        values: ParameterValues,
        scale: np.ndarray,
    ) -> None:
        parts = [cut_into_segments(r, SEGMENT, scale, values) for r in recordings]
        self.shooting, self.values, self.names = Shooting(parts, names, values), values, names
        self.slopes = self.shooting.slopes(values.vector(names))
        self.basis, _ = np.linalg.qr(self.slopes)
        states = [self.shooting.initial_states(i) for i in range(len(parts))]
        self.initial = [initial.copy() for initial, _ in states]
        self.state_slopes = [slopes for _, slopes in states]
        self._bases = [
            [(rows, np.linalg.qr(slopes[rows])[0]) for rows in segment_rows(part)]
            for part, slopes in zip(parts, self.state_slopes, strict=True)
        ]

    def of(self, coupling: Coupling) -> np.ndarray:
        """Residuals of a coupling; of one that is not elastic, those of the rigid model."""
        residuals = np.concatenate(self._without_states(coupling))
        return residuals - self.basis @ (self.basis.T @ residuals)

    def _without_states(self, coupling: Coupling) -> list[np.ndarray]:
        """Residuals of each recording without what other states at the starts explain."""
        all_residuals = [self._raw(i, coupling) for i in range(len(self.initial))]
        for residuals, bases in zip(all_residuals, self._bases, strict=True):
            for rows, basis in bases:
                residuals[rows] -= basis @ (basis.T @ residuals[rows])
        return all_residuals

    def _raw(self, i: int, coupling: Coupling) -> np.ndarray:
        """Residuals (4n + 5s,) of one recording: outputs, then initial states."""
        part, initial = self.shooting.parts[i], self.initial[i].copy()
        zero = self.values.zero(part.recording.number)
        initial[:, THETA] += zero
        arguments = part.recording, part.starts, initial
        predicted = (
            predict_elastic(*arguments, self.values, coupling)
            if coupling.is_elastic
            else predict(*arguments, self.values.model)
        )
        predicted[:, THETA] -= zero
        error = (part.recording.measured - predicted) / part.scale
        error = np.where(np.isfinite(error), error, 0.0)
        prior = (part.measured - self.initial[i]) / np.where(part.spread > 0.0, part.spread, np.inf)
        return np.append(error.ravel(), prior.ravel())

    def improved(self, coupling: Coupling) -> CouplingResiduals:
        """With values and states at the starts that fit a coupling better: a Gauss-Newton step."""
        moved = [k for k, name in enumerate(self.names) if name not in FIXED]
        names, slopes = [self.names[k] for k in moved], self.slopes[:, moved]
        vector, (mean, _), certainty = (
            self.values.vector(names),
            prior(names),
            prior_information(names),
        )
        residuals = np.concatenate(self._without_states(coupling))
        step = np.linalg.solve(
            slopes.T @ slopes + certainty, slopes.T @ residuals + certainty @ (vector - mean)
        )
        better = copy(self)
        better.values = self.values.changed(
            names, np.clip(vector - step, *bounds(self.values, names))
        )
        better.initial = [better._improved_states(i, coupling) for i in range(len(self.initial))]
        return better

    def _improved_states(self, i: int, coupling: Coupling) -> np.ndarray:
        """States (s, 5) at the starts after a Gauss-Newton step, where it is better."""
        part, before = self.shooting.parts[i], self._raw(i, coupling)
        after = copy(self)
        after.initial = list(self.initial)
        after.initial[i] = self.initial[i] - gauss_newton_steps(self.state_slopes[i], before, part)
        sums = [sums_of_squares(r, part) for r in (before, after._raw(i, coupling))]
        better = sums[1] < sums[0]
        return np.where(better[:, None], after.initial[i], self.initial[i])

    @property
    def root_mean_square(self) -> np.ndarray:
        """Of each channel's rigid residuals (4,); 1 where nothing was measured."""
        rows = []
        for i, part in enumerate(self.shooting.parts):
            outputs = self._raw(i, Coupling())[: part.recording.measured.size]
            rows.append(outputs.reshape(-1, RIGID_STATES) * part.scale)
        size = np.sqrt(np.mean(np.concatenate(rows) ** 2, axis=0))
        return np.where(size > 0.0, size, 1.0)

    @property
    def floor(self) -> float:
        """Sum of squares that the sensors' noise leaves."""
        return sum(
            len(part.recording.time)
            * float(np.sum((noise_of(part.recording) / part.scale)[known] ** 2))
            for part in self.shooting.parts
            for known in [np.isfinite(part.recording.measured).any(axis=0)]
        )

    def size(self, vector: np.ndarray, side: str) -> float:
        """Sum of squares of a coupling."""
        residuals = self.of(coupling_of(vector, side))
        return float(residuals @ residuals)

    def fit(self, vector: np.ndarray, side: str, free: slice) -> ElasticFit:
        """Fit some unknowns, at last with slopes over steps of the size of standard errors."""
        steps = STEPS[free]
        for _ in range(2):
            fitted = self._fit(vector, side, steps, free)
            vector = fitted.vector
            errors = np.sqrt(np.diag(self.covariance(fitted)))
            steps = np.clip(errors, SMALLEST_STEPS[free], STEPS[free])
        return fitted

    def _fit(self, start: np.ndarray, side: str, steps: np.ndarray, free: slice) -> ElasticFit:
        low, high = LOWEST[free], HIGHEST[free]

        def whole(x: np.ndarray) -> np.ndarray:
            return np.concatenate((start[: free.start], x, start[free.stop :]))

        def residuals(x: np.ndarray) -> np.ndarray:
            return self.of(coupling_of(whole(x), side))

        def slopes(x: np.ndarray) -> np.ndarray:
            columns = []
            for step in np.diag(steps):
                below, above = np.maximum(x - step, low), np.minimum(x + step, high)
                columns.append((residuals(above) - residuals(below)) / np.sum(above - below))
            return np.stack(columns, axis=1)

        margin = 1e-3 * (high - low)
        best = least_squares(
            residuals,
            np.clip(start[free], low + margin, high - margin),
            jac=slopes,
            bounds=(low, high),
            x_scale=steps,
            ftol=1e-4,
            xtol=1e-4,
            max_nfev=EVALUATIONS,
        )
        return ElasticFit(whole(best.x), side, best.fun, best.jac)

    def refined(
        self, fit: ElasticFit, free: slice
    ) -> tuple[CouplingResiduals, ElasticFit, np.ndarray]:
        """Fit rigid model and coupling in turn; also the last change of the vector."""
        best, change = self, np.zeros(len(fit.slopes.T))
        for _ in range(ROUNDS):
            better = best.improved(fit.coupling)
            again = better.fit(fit.vector, fit.side, free)
            if again.size >= fit.size:
                break
            converged = again.size > CONVERGED * fit.size
            change = (again.vector - fit.vector)[free]
            best, fit = better, again
            if converged:
                break
        return best, fit, change

    def covariance(self, fit: ElasticFit) -> np.ndarray:
        """Covariance of a fit by the jackknife over blocks of time."""
        information = fit.slopes.T @ fit.slopes
        return block_scatter(blocks_of(self.shooting), fit.slopes, fit.residuals, information)

    def gains(self, fit: ElasticFit, rigid: np.ndarray) -> np.ndarray:
        """How much better each part is predicted from the others than by a rigid arm (4,)."""
        gains, blocks = [], blocks_of(self.shooting)
        for chosen in np.array_split(np.arange(len(blocks)), PARTS):
            rows = np.concatenate([np.r_[blocks[k]] for k in chosen])
            slopes, residuals = fit.slopes[rows], fit.residuals[rows]
            rest = np.linalg.pinv(fit.slopes.T @ fit.slopes - slopes.T @ slopes)
            left = residuals + slopes @ (rest @ (slopes.T @ residuals))
            gains.append(rigid[rows] @ rigid[rows] - left @ left)
        return np.array(gains)
