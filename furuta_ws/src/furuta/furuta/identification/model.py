"""The result of a fit, and what it predicts."""

from typing import NamedTuple

import numpy as np

from furuta.identification.shooting.optimisation import fit_percent, optimise
from furuta.identification.shooting.unknowns import ParameterValues
from furuta.identification.unknowns import Key
from furuta_recordings.recording import CHANNELS, Recording


class Prediction(NamedTuple):
    """A recording and what a model predicts for it: ``predicted`` (n, 4)."""

    recording: Recording
    predicted: np.ndarray

    def fits(self, seconds: float = np.inf) -> dict[str, float]:
        """Fit [%] of each channel over the first ``seconds``."""
        chosen = self.recording.time - self.recording.time[0] < seconds
        return {
            name: fit_percent(self.recording.measured[chosen, k], self.predicted[chosen, k])
            for k, name in enumerate(CHANNELS)
        }


class Model(NamedTuple):
    """A fitted model.

    ``keys`` are the fitted unknowns, then those that had to be assumed; ``covariance`` is that of
    their vector, ``information`` the data's part of its inverse. ``window`` [s] is infinite for
    free runs, ``scale`` (4,) the residual of each channel that counts as one.

    ``command_negated`` is True if a positive command turns the arm in its negative direction.
    ``angles`` is the unit of the recorded angles, ``direction`` that of the pendulum's angle.
    ``command_delay`` [s] was applied to the recordings' commands before the rest of the delay was
    fitted.
    """

    values: ParameterValues
    keys: list[Key]
    covariance: np.ndarray
    information: np.ndarray
    window: float
    scale: np.ndarray
    recordings: list[Recording]
    findings: list[str]
    command_negated: bool = False
    command_delay: float = 0.0
    angles: str = "rad"
    direction: float = 1.0

    @property
    def fitted(self) -> list[Key]:
        """The unknowns that were fitted, without those that had to be assumed."""
        return [key for key, row in zip(self.keys, self.information, strict=True) if row.any()]

    def predict(self, recording: Recording) -> Prediction:
        """Simulate along a prepared recording, as the model was fitted: freely or in segments.

        The initial states of segments are fitted, and so is that of a free run that starts in
        motion. A free run from rest starts from the measured state.
        """
        states = optimise([recording], (), self.values, self.window, self.scale, robust=False)
        return Prediction(*states.predictions[0])
