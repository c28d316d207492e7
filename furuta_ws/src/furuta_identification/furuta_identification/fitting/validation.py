"""Predicts recordings with a fitted model, and how well predictions agree with measurements."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_identification.fitting.model import Model
from furuta_identification.fitting.optimisation import Optimum
from furuta_identification.preparation.options import Options
from furuta_identification.preparation.prepare import prepare
from furuta_identification.shooting.segments import cut_into_segments
from furuta_identification.shooting.shooting import Shooting
from furuta_model.state import PHI, THETA
from furuta_recordings.recording import CHANNELS, Recording

# Duration [s] at the start over which the pendulum's rest angle is taken.
REST = 0.1
# Largest movement [rad] of a pendulum at rest, and largest deviation [rad] of its angle from the
# rest angle of the model that is not another zero.
LARGEST_ZERO_ERROR = 0.03
# Standard deviation of a series [rad, rad/s] below which nothing moves in it.
SMALLEST_MOTION = 1e-6


def fit_percent(measured: np.ndarray, predicted: np.ndarray) -> float:
    """100·(1 − ‖y − ŷ‖/‖y − ȳ‖) [%]; NaN for a series (n,) without values or without motion."""
    here = np.isfinite(measured)
    y, y_hat = measured[here], predicted[here]
    if not len(y) or np.std(y) < SMALLEST_MOTION:
        return float("nan")
    return float(100.0 * (1.0 - np.linalg.norm(y - y_hat) / np.linalg.norm(y - np.mean(y))))


def worst_pendulum_fit(optimum: Optimum) -> float:
    """The smallest fit of the pendulum's angle [%] over the recordings."""
    predictions = optimum.shooting.predictions(optimum.vector)
    return min(
        fit_percent(part.recording.measured[:, THETA], predicted[:, THETA])
        for part, predicted in zip(optimum.shooting.parts, predictions, strict=True)
    )


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


def predict_prepared(model: Model, recording: Recording) -> Prediction:
    """Simulate the model along a prepared recording, as it was fitted: freely or in segments.

    The initial states of segments are fitted, and so is that of a free run that starts in motion.
    A free run from rest starts from the measured state.
    """
    names = [name for name in model.names if name != "coulomb"]
    segments = cut_into_segments(recording, model.window, model.scale, model.values)
    shooting = Shooting([segments], names, model.values)
    return Prediction(recording, shooting.predictions(model.values.vector(names))[0])


def validate(model: Model, recording: Recording, options: Options) -> tuple[Prediction, list[str]]:
    """Simulate the model along a recording that it was not fitted to; and what was found.

    If the pendulum rests at an angle that does not match the model's zero, its encoder was started
    at another angle, and the zero is taken from that rest.
    """
    ready, findings = prepare(recording, options)
    if model.command_negated:
        ready = ready.with_command_negated()
    ready = ready.with_delayed_command(model.command_delay)
    at_rest = ready.between(ready.time[0], ready.time[0] + REST).measured[:, THETA]
    if np.isinf(model.window) and np.ptp(at_rest) < LARGEST_ZERO_ERROR:
        error = _zero_error(model, float(ready.measured[0, PHI]), float(np.mean(at_rest)))
        if abs(error) > LARGEST_ZERO_ERROR:
            zero = model.values["zero"] - error
            model = model._replace(values=model.values.changed(["zero"], [zero]))
            findings.append(
                f"{recording.name}: the pendulum's zero differs by {error:.3f} rad: corrected"
            )
    return predict_prepared(model, ready), findings


def _zero_error(model: Model, phi: float, rest: float) -> float:
    """How far the pendulum's measured ``rest`` is from the model's at the arm's angle ``phi``.

    Hanging, sinθ ≈ −(θ − π) and cosθ ≈ −1 balance the torque of the tilt.
    """
    values = model.values
    deviation = rest + values["zero"] - np.pi
    expected = values["tilt_y"] * np.cos(phi) - values["tilt_x"] * np.sin(phi)
    deviation = (deviation - expected + np.pi) % (2 * np.pi) - np.pi
    return float(deviation)
