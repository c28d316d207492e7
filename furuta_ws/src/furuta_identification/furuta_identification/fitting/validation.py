"""Predicts recordings with a fitted model, and how well predictions agree with measurements."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_identification.fitting.ceiling import ceiling_of
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
# Largest pendulum angle [rad] of a pendulum that was balanced, and its segments [s].
LARGEST_BALANCED_ANGLE, SEGMENT = 0.7, 0.5
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
    part = cut_into_segments(recording, model.window, model.scale, model.values)
    return Prediction(recording, Shooting([part], [], model.values).predictions(np.zeros(0))[0])


def validate(model: Model, recording: Recording, options: Options) -> tuple[Prediction, list[str]]:
    """Simulate the model along a recording that it was not fitted to; and what was found.

    The recording has the units of the fitted ones, but its own zero, which a hanging pendulum at
    rest shows, and its own ceiling if its commands are larger than those of the fit.
    """
    options = options._replace(angles=model.angles)
    ready, findings = prepare(recording, options, model.direction)
    if model.command_negated:
        ready = ready.with_command_negated()
    ready = ready.with_delayed_command(model.command_delay)
    if is_balanced(ready):
        return predict_prepared(model._replace(window=min(model.window, SEGMENT)), ready), findings
    model, found = _with_own_zero(model, ready)
    findings += found
    ceiling = ceiling_of(model, ready)
    if ceiling != model.values["ceiling"]:
        model = model._replace(values=model.values.changed(["ceiling"], [np.log(ceiling)]))
        findings.append(
            f"{recording.name}: the drive reaches {ceiling:.3g} V (fitted to this recording: its "
            f"commands exceed those of the fit, {model.largest_command:.3g} V); name another "
            "ceiling with --ceiling"
        )
    return predict_prepared(model, ready), findings


def is_balanced(recording: Recording) -> bool:
    """Whether the pendulum stays near upright."""
    return bool(np.max(np.abs(recording.measured[:, THETA])) < LARGEST_BALANCED_ANGLE)


def _with_own_zero(model: Model, recording: Recording) -> tuple[Model, list[str]]:
    """The model with the recording's own zero.

    That is the zero of the nearest fitted recording. If the pendulum hangs at rest at an angle that
    none of them explains, its encoder was started at another angle.
    """
    zeros = [model.values.zero(each.number) for each in model.recordings]
    first = recording.between(recording.time[0], recording.time[0] + REST).measured
    at_rest = np.ptp(first[:, THETA]) < LARGEST_ZERO_ERROR
    errors = [_zero_error(model, zero, first) for zero in zeros]
    if not (at_rest and min(np.abs(errors)) < LARGEST_BALANCED_ANGLE):
        return model._replace(values=model.values.with_zero(float(np.mean(zeros)))), []
    best = int(np.argmin(np.abs(errors)))
    error, findings = errors[best], []
    if abs(error) > LARGEST_ZERO_ERROR:
        zeros[best] -= error
        findings = [f"{recording.name}: the pendulum's zero differs by {error:.3f} rad: corrected"]
    return model._replace(values=model.values.with_zero(zeros[best])), findings


def _zero_error(model: Model, zero: float, first: np.ndarray) -> float:
    """How far a measured rest (n, 4) is from the model's with a ``zero`` [rad].

    Hanging, sinθ ≈ −(θ − π) and cosθ ≈ −1 balance the torque of the tilt.
    """
    values, phi = model.values, float(first[0, PHI])
    deviation = float(np.mean(first[:, THETA])) + zero - np.pi
    expected = values["tilt_y"] * np.cos(phi) - values["tilt_x"] * np.sin(phi)
    return float((deviation - expected + np.pi) % (2 * np.pi) - np.pi)
