"""Predicts a recording that a model was not fitted to."""

import numpy as np
from scipy.optimize import minimize_scalar

from furuta_identification.fitting.balanced import LARGEST_ANGLE, SEGMENT, is_balanced
from furuta_identification.model import Model, Prediction
from furuta_identification.options import Options
from furuta_identification.preparation.prepare import prepare
from furuta_identification.regression.equations import PARTS, SURE
from furuta_identification.regression.windows import correlation_length
from furuta_identification.shooting.segments import cut_into_segments
from furuta_identification.shooting.shooting import Shooting
from furuta_model.state import PHI, PHI_DOT, RIGID_STATES, THETA
from furuta_recordings.recording import Recording

# Duration [s] at the start over which the pendulum's rest angle is taken.
REST = 0.1
# Largest movement [rad] of a pendulum at rest, and largest deviation [rad] of its angle from the
# rest angle of the model that is not another zero.
LARGEST_ZERO_ERROR = 0.03
# Part by which a command must exceed those of the fit before it may meet an unknown ceiling.
FARTHER = 1.02
# A model whose scale is slightly wrong also fits better with a ceiling just below the command. So a
# ceiling counts only this far below it and if residuals shrink by this ratio.
CLEARLY_LOWER, SMALLEST_RATIO = 0.95, 1.5


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
        return model._replace(window=min(model.window, SEGMENT)).predict(ready), findings
    model, remarks = _with_own_zero(model, ready)
    findings += remarks
    ceiling = _own_ceiling(model, ready)
    if ceiling != model.values["ceiling"]:
        model = model._replace(values=model.values.changed(["ceiling"], [np.log(ceiling)]))
        findings.append(
            f"{recording.name}: the drive reaches {ceiling:.3g} V (fitted to this recording: its "
            f"commands exceed those of the fit, {model.largest_command:.3g} V); name another "
            "ceiling with --ceiling"
        )
    return model.predict(ready), findings


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


def _own_ceiling(model: Model, recording: Recording) -> float:
    """The ceiling [V] of a recording with larger commands than those of the fit; else infinite.

    It is the only value that is fitted to this recording.
    """
    largest = recording.largest_command
    if np.isfinite(model.values["ceiling"]) or largest < FARTHER * model.largest_command:
        return model.values["ceiling"]

    def residuals(ceiling: float) -> np.ndarray:
        """Weighted residuals (n, 4)."""
        values = model.values.changed(["ceiling"], [np.log(ceiling)])
        part = cut_into_segments(recording, model.window, model.scale, values)
        weighted = Shooting([part], [], values).residuals(np.zeros(0))
        return weighted[: RIGID_STATES * len(recording.time)].reshape(-1, RIGID_STATES)

    def size(ceiling: float) -> float:
        return float(np.linalg.norm(residuals(ceiling)))

    candidates = [part * largest for part in PARTS if part * largest >= model.largest_command]
    if not candidates:
        return float(np.inf)
    best = min(candidates, key=size)
    reach = (PARTS[1] - PARTS[0]) * largest
    ceiling = minimize_scalar(size, bounds=(best - reach, best + reach)).x
    arm = residuals(ceiling)[:, PHI_DOT]
    samples = len(arm) / correlation_length(arm)
    ratio = size(np.inf) / size(ceiling)
    sure = samples * np.log(ratio) > SURE and ratio > SMALLEST_RATIO
    return float(ceiling) if sure and ceiling < CLEARLY_LOWER * largest else float(np.inf)
