"""Fits of a pendulum, and how large their residuals are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from furuta.identification.averaging import Catalogue, Neighbourhood
from furuta.identification.bodies.pendulum import Pendulum
from furuta.identification.least_squares import (
    Fit,
    Linearised,
    Problem,
    State,
    fit,
    in_blocks,
    linearised,
)
from furuta.identification.shooting.segments import cut_into_segments
from furuta.identification.shooting.unknowns import BODY, ParameterValues, unknowns_of
from furuta.identification.unknowns import Key
from furuta_model.state import THETA
from furuta_recordings.recording import Recording

# Standard deviation of a series [rad, rad/s] below which nothing moves in it.
SMALLEST_MOTION = 1e-6
# Relative change of the sum of squares at which a fit ends: the last fit, and one on the way.
FINE, COARSE = 1e-9, 1e-4
# Length [s] of a block, within which residuals may be correlated in any way, and unknowns of which
# every block informs.
BLOCK, SURE = 0.5, (*BODY, "viscous", "coulomb")
# Consecutive samples that carry the information of one, where errors of the model dominate noise.
CORRELATED_SAMPLES = 100.0


class Optimum(NamedTuple):
    """A fit of recordings in segments of ``window`` [s].

    ``scale`` (4,) is the residual of each channel that counts as one.
    """

    problem: Problem
    fit: Fit
    window: float
    scale: np.ndarray

    @property
    def values(self) -> ParameterValues:
        """All values."""
        return ParameterValues(self.fit.values)

    @property
    def keys(self) -> list[Key]:
        """The fitted unknowns."""
        return list(self.fit.unknowns.keys)

    @property
    def cost(self) -> float:
        """That of residuals, first states and priors."""
        return self.fit.cost

    def inflation(self, sure: Sequence[Key]) -> float:
        """Variance by blocks over that of white noise."""
        return self.in_blocks().inflation(sure)

    def in_blocks(self) -> Fit:
        """The fit by blocks of time, whatever the segments are."""
        return self.fit._replace(about=self._blocks(self.about()))

    def neighbourhood(self, catalogue: Catalogue) -> Neighbourhood:
        """The problem about the fit with all effects of a catalogue."""
        keys = list(catalogue.keys(self.keys))
        values = ParameterValues({**dict.fromkeys(keys, 0.0), **self.fit.values})
        about = self._blocks(self.about(keys[len(self.keys) :]))
        best = self.fit._replace(about=about.first(len(self.keys)))
        unknowns = unknowns_of(keys, values)
        return Neighbourhood.of(about, unknowns, values.coordinates, best, SURE)

    def _blocks(self, about: Linearised) -> Linearised:
        return in_blocks(about, self.problem.cut, self.fit.state, BLOCK)

    @property
    def vector(self) -> np.ndarray:
        """Values of the fitted unknowns."""
        return self.values.vector(self.keys)

    @property
    def recordings(self) -> list[Recording]:
        """The fitted recordings."""
        return list(self.problem.cut.data)

    @property
    def predictions(self) -> list[tuple[Recording, np.ndarray]]:
        """The recordings with what is predicted for them (n, 4)."""
        return list(zip(self.recordings, predicted(self.problem, self.fit.state), strict=True))

    def refitted(
        self, keys: Sequence[Key], start: ParameterValues, tolerance: float = COARSE
    ) -> Optimum:
        """A fit of the same recordings with other unknowns or from another start."""
        return optimise(
            self.recordings, keys, start, self.window, self.scale, True, tolerance=tolerance
        )

    def about(self, more: Sequence[Key] = ()) -> Linearised:
        """The problem about the fit, with more unknowns; all residuals count by their squares."""
        values = ParameterValues({**dict.fromkeys(more, 0.0), **self.fit.values})
        unknowns = unknowns_of([*self.keys, *more], values)
        problem = Problem(self.problem.body, self.problem.cut, unknowns)
        return linearised(problem, self.fit.state._replace(values=values.coordinates))


def optimise(
    recordings: Sequence[Recording],
    keys: Sequence[Key],
    start: ParameterValues,
    window: float,
    scale: np.ndarray,
    robust: bool,
    tolerance: float = COARSE,
) -> Optimum:
    """Fit some unknowns; ``robust`` limits the influence of large residuals."""
    unknowns = unknowns_of(keys, start)
    inside = np.clip(unknowns.vector(start.coordinates), unknowns.all("low"), unknowns.all("high"))
    cut = cut_into_segments(recordings, window, scale, start)
    problem = Problem(Pendulum(), cut, unknowns, robust)
    values = unknowns.changed(start.coordinates, inside)
    enough = tolerance * np.count_nonzero(cut.weight)
    return Optimum(problem, fit(problem, values, enough=enough), window, scale)


def predicted(problem: Problem, state: State) -> list[np.ndarray]:
    """Outputs (n, 4) of each recording."""
    cut = problem.cut
    outputs = problem.body.outputs(state.values, state.first, cut)
    return np.split(outputs, np.cumsum([len(recording.time) for recording in cut.data])[:-1])


def residual_scale(optimum: Optimum) -> np.ndarray:
    """Root mean square of each channel's residuals (4,), widened for their correlation in time."""
    residuals = np.concatenate([r.measured - predicted for r, predicted in optimum.predictions])
    count = np.sum(np.isfinite(residuals), axis=0)
    size = np.sqrt(np.nansum(residuals**2, axis=0) / np.maximum(count, 1))
    size = np.where(count > 0, size, 1.0)
    widened: np.ndarray = np.maximum(np.sqrt(CORRELATED_SAMPLES) * size, 1e-4)
    return widened


def fit_percent(measured: np.ndarray, predicted: np.ndarray) -> float:
    """100·(1 − ‖y − ŷ‖/‖y − ȳ‖) [%]; NaN for a series (n,) without values or without motion."""
    here = np.isfinite(measured)
    y, y_hat = measured[here], predicted[here]
    if not len(y) or np.std(y) < SMALLEST_MOTION:
        return float("nan")
    return float(100.0 * (1.0 - np.linalg.norm(y - y_hat) / np.linalg.norm(y - np.mean(y))))


def worst_pendulum_fit(optimum: Optimum) -> float:
    """The smallest fit of the pendulum's angle [%] over the recordings."""
    return min(
        fit_percent(r.measured[:, THETA], predicted[:, THETA])
        for r, predicted in optimum.predictions
    )
