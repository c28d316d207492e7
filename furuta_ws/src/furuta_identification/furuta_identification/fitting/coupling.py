"""Whether a recording shows an elastic coupling of motor and arm, or backlash.

Two masses (:mod:`furuta_model.parts.coupling`) are simulated along segments of 0.5 s, from the
states of the rigid fit. What other values of the rigid model or other states at the starts could
explain does not count. Resonance, damping ratio, the motor's share of the inertia and the side of
the sensors are searched on a grid and fitted, in turn with the rigid model. The recording shows
them if they predict each quarter of it, from the other quarters, better than a rigid arm does.

Impacts in a gap have many optima: its size is searched, but not determined. If a gap predicts
better than a resonance, the recording shows backlash.
"""

from __future__ import annotations

from copy import copy
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from furuta_identification.model import CouplingFit, Model
from furuta_identification.shooting.elastic_prediction import predict_elastic
from furuta_identification.shooting.optimisation import noise_of, quantisation_step
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
from furuta_model.parts.coupling import SIDES, Coupling
from furuta_model.state import PHI, RIGID_STATES, THETA
from furuta_recordings.recording import Recording

# Length of the segments [s], most samples, and parts that predict each other.
SEGMENT, MOST_SAMPLES, PARTS = 0.5, 12_000, 4
# Unknowns: logarithms of frequency [Hz] and damping ratio, share of the motor, gap [rad].
NAMES = ("frequency", "damping", "motor_inertia")
LOWEST = np.array([np.log(8.0), np.log(0.003), 0.04, 1e-5])
HIGHEST = np.array([np.log(400.0), np.log(0.6), 0.96, 0.2])
# Steps of the slopes at first, and smallest ones: a motion with impacts is rough.
STEPS, SMALLEST_STEPS = np.array([0.02, 0.2, 0.01, 1e-4]), np.array([1e-4, 1e-3, 1e-4, 1e-5])
# Grids: resonances; and gaps, without ringing after an impact.
FREQUENCIES, SHARES, DAMPING = np.geomspace(15.0, 220.0, 25), (0.3, 0.7), 0.05
GAPS, GAP_SHARES, GAP_FREQUENCY, GAP_DAMPING = (
    np.geomspace(7e-4, 0.04, 8),
    (0.2, 0.4, 0.6, 0.8),
    150.0,
    0.3,
)
RESONANCE, GAP = slice(0, 3), slice(2, 4)
# What the rigid model keeps while the coupling is fitted: their effect is far from linear.
FIXED = ("alpha1", "stribeck_velocity")
EVALUATIONS, ROUNDS, CONVERGED = 12, 4, 0.999
# Largest standard error of the logarithms, and of the share, of values that are reported.
LARGEST_ERRORS = {"frequency": 0.1, "damping": 0.5, "motor_inertia": 0.1}
# Largest part that a resonance may leave of what a rigid arm leaves beyond noise.
LARGEST_PART_LEFT = 0.5
# Part of the command's power that counts as its spectrum.
MOST_POWER = 0.99


class _Fit(NamedTuple):
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
        return _coupling(self.vector, self.side)


def _coupling(vector: np.ndarray, side: str) -> Coupling:
    frequency, damping = map(float, np.exp(vector[:2]))
    gap = float(vector[3]) if len(vector) > 3 else 0.0
    return Coupling(frequency, damping, float(vector[2]), gap, sensors=side)


class _Residuals:
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

    def improved(self, coupling: Coupling) -> _Residuals:
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
        residuals = self.of(_coupling(vector, side))
        return float(residuals @ residuals)

    def fit(self, vector: np.ndarray, side: str, free: slice) -> _Fit:
        """Fit some unknowns, at last with slopes over steps of the size of standard errors."""
        steps = STEPS[free]
        for _ in range(2):
            fitted = self._fit(vector, side, steps, free)
            vector = fitted.vector
            errors = np.sqrt(np.diag(self.covariance(fitted)))
            steps = np.clip(errors, SMALLEST_STEPS[free], STEPS[free])
        return fitted

    def _fit(self, start: np.ndarray, side: str, steps: np.ndarray, free: slice) -> _Fit:
        low, high = LOWEST[free], HIGHEST[free]

        def whole(x: np.ndarray) -> np.ndarray:
            return np.concatenate((start[: free.start], x, start[free.stop :]))

        def residuals(x: np.ndarray) -> np.ndarray:
            return self.of(_coupling(whole(x), side))

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
        return _Fit(whole(best.x), side, best.fun, best.jac)

    def refined(self, fit: _Fit, free: slice) -> tuple[_Residuals, _Fit, np.ndarray]:
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

    def covariance(self, fit: _Fit) -> np.ndarray:
        """Covariance of a fit by the jackknife over blocks of time."""
        information = fit.slopes.T @ fit.slopes
        return block_scatter(blocks_of(self.shooting), fit.slopes, fit.residuals, information)

    def gains(self, fit: _Fit, rigid: np.ndarray) -> np.ndarray:
        """How much better each part is predicted from the others than by a rigid arm (4,)."""
        gains, blocks = [], blocks_of(self.shooting)
        for chosen in np.array_split(np.arange(len(blocks)), PARTS):
            rows = np.concatenate([np.r_[blocks[k]] for k in chosen])
            slopes, residuals = fit.slopes[rows], fit.residuals[rows]
            rest = np.linalg.pinv(fit.slopes.T @ fit.slopes - slopes.T @ slopes)
            left = residuals + slopes @ (rest @ (slopes.T @ residuals))
            gains.append(rigid[rows] @ rigid[rows] - left @ left)
        return np.array(gains)


def find_coupling(model: Model) -> CouplingFit:
    """The coupling that the recordings of a model show, or why they show none."""
    problem = _problem(model)
    rigid = problem.of(Coupling())
    refined, fit, change = problem.refined(_resonance(problem), RESONANCE)
    gap = _gap(problem)
    beyond, left = rigid @ rigid - problem.floor, fit.size - problem.floor
    gains, gap_gains = refined.gains(fit, rigid), problem.gains(gap, rigid)
    if _shown(gap_gains, rigid) and np.sum(gap_gains) > np.sum(gains):
        return CouplingFit(remark=BACKLASH.format(gap.side))
    errors = np.sqrt(np.diag(refined.covariance(fit)) + change**2)
    # What is left beyond noise is an error of the model, which the jackknife does not show.
    errors *= np.sqrt(max(1.0, fit.size / problem.floor))
    named = dict(zip(NAMES, map(float, errors), strict=True))
    if not _shown(gains, rigid) or fit.coupling.frequency > FREQUENCIES[-1]:
        return CouplingFit(remark=_not_shown(model.recordings))
    if left > LARGEST_PART_LEFT * beyond or named["frequency"] > LARGEST_ERRORS["frequency"]:
        return CouplingFit(remark=UNEXPLAINED)
    known = {name: error for name, error in named.items() if error < LARGEST_ERRORS[name]}
    assumed = {name: getattr(Coupling(), name) for name in NAMES if name not in known}
    c = fit.coupling._replace(**assumed)
    known |= {name: known[name] * getattr(c, name) for name in NAMES[:2] if name in known}
    return CouplingFit(c, known, ELASTIC.format(c.sensors))


BACKLASH = (
    "the recording shows backlash (arm's sensors on the {}), but does not determine its size: "
    "impacts explain it in several ways"
)
UNEXPLAINED = (
    "the recording shows more than a rigid arm, but does not determine a resonance: backlash or "
    "another error of the model"
)
ELASTIC = "the arm's sensors are on the {}; all friction is assumed to act on the motor"


def _not_shown(recordings: list[Recording]) -> str:
    """The sentence that says so, with what limits the recordings."""
    first = recordings[0]
    spectrum = np.abs(np.fft.rfft(first.commanded_at(first.time))) ** 2
    share = np.cumsum(spectrum) / max(np.sum(spectrum), 1e-300)
    highest = np.searchsorted(share, MOST_POWER) / first.duration
    step = 1e3 * quantisation_step(first.measured[:, PHI])
    return (
        "the recording does not show an elastic coupling or backlash: 99 % of the command's power "
        f"lies below {highest:.2g} Hz, a step of the arm's angle is {step:.2g} mrad"
    )


def _shown(gains: np.ndarray, rigid: np.ndarray) -> bool:
    """Whether every part gains, and together more than the criterion of Schwarz asks for.

    See :mod:`.waves`; the side of the sensors counts as an unknown.
    """
    samples, left = len(rigid), float(rigid @ rigid)
    least = left * -np.expm1(-(len(NAMES) + 1) * np.log(samples) / samples)
    return bool(np.all(gains > 0.0) and np.sum(gains) > least)


def _problem(model: Model) -> _Residuals:
    """The first samples of all recordings; each channel is weighted by its rigid residuals."""
    most = MOST_SAMPLES // len(model.recordings)
    recordings = [
        r._replace(time=r.time[:most], measured=r.measured[:most]) for r in model.recordings
    ]
    scale = np.median([noise_of(r) for r in recordings], axis=0)
    scale = _Residuals(recordings, model.fitted, model.values, scale).root_mean_square
    return _Residuals(recordings, model.fitted, model.values, scale)


def _resonance(problem: _Residuals) -> _Fit:
    """A fit without gap, from the best of a grid."""
    grid = [
        (np.array([np.log(frequency), np.log(DAMPING), share]), side)
        for frequency, share, side in product(FREQUENCIES, SHARES, SIDES)
    ]
    return problem.fit(*min(grid, key=lambda start: problem.size(*start)), RESONANCE)


def _gap(problem: _Residuals) -> _Fit:
    """A fit of gap and share, from the best of a grid."""
    grid = [
        (np.array([np.log(GAP_FREQUENCY), np.log(GAP_DAMPING), share, gap]), side)
        for gap, share, side in product(GAPS, GAP_SHARES, SIDES)
    ]
    return problem.fit(*min(grid, key=lambda start: problem.size(*start)), GAP)
