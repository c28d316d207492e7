"""Predicts a recording that a model was not fitted to."""

import numpy as np

from furuta_identification.fitting.balanced import LARGEST_ANGLE, SEGMENT, is_balanced
from furuta_identification.model import Model, Prediction
from furuta_identification.options import Options
from furuta_identification.preparation.prepare import prepare
from furuta_model.state import PHI, THETA
from furuta_recordings.recording import Recording

# Duration [s] at the start over which the pendulum's rest angle is taken.
REST = 0.1
# Largest movement [rad] of a pendulum at rest, and largest deviation [rad] of its angle from the
# rest angle of the model that is not another zero.
LARGEST_ZERO_ERROR = 0.03


def validate(model: Model, recording: Recording, options: Options) -> tuple[Prediction, list[str]]:
    """Simulate the model along a recording that it was not fitted to; and what was found.

    The recording has the units of the fitted ones, but its own zero, which a hanging pendulum at
    rest shows.
    """
    options = options._replace(angles=model.angles)
    ready, findings = prepare(recording, options, model.direction)
    if model.command_negated:
        ready = ready.with_command_negated()
    ready = ready.with_delayed_command(model.command_delay)
    if is_balanced(ready):
        return model._replace(window=min(model.window, SEGMENT)).predict(ready), findings
    model, remarks = _with_own_zero(model, ready)
    return model.predict(ready), findings + remarks


def _with_own_zero(model: Model, recording: Recording) -> tuple[Model, list[str]]:
    """The model with the recording's own zero.

    That is the zero of the nearest fitted recording. If the pendulum hangs at rest at an angle that
    none of them explains, its encoder was started at another angle.
    """
    zeros = [model.values.zero(fitted.number) for fitted in model.recordings]
    first = recording.between(recording.time[0], recording.time[0] + REST).measured
    at_rest = np.ptp(first[:, THETA]) < LARGEST_ZERO_ERROR
    errors = [_zero_error(model, zero, first) for zero in zeros]
    if not (at_rest and min(np.abs(errors)) < LARGEST_ANGLE):
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
