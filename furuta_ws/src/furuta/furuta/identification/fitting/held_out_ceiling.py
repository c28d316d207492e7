"""The drive's ceiling from a held-out recording whose commands go beyond all fitted ones."""

import numpy as np

from furuta.identification.model import Model, Prediction
from furuta.identification.shooting.optimisation import FINE, Optimum, optimise
from furuta.identification.uncertainty.covariance import covariance_and_information
from furuta.identification.unknowns import field_of

# Ceilings that are tried first, between the largest fitted command and the largest one.
TRIED = 9
# The drive may clip if that leaves at most this part of the prediction's error, and if the ceiling
# is so many standard errors below the largest command.
LARGEST_REST, SURE_ERRORS = 0.5, 3.0


def with_ceiling(model: Model, prediction: Prediction) -> Prediction:
    """The prediction, noting a ceiling that explains why the rig does less than commanded.

    The ceiling is fitted to the held-out recording: the prediction itself does not have it.
    """
    recording = prediction.recording
    known = max(fitted.largest_command for fitted in model.recordings)
    if np.isfinite(model.values["ceiling"]) or recording.largest_command <= known:
        return prediction
    optimum = _fitted(model, prediction, known)
    clipped = Prediction(recording, optimum.predictions[0][1])
    error = _standard_error(model, optimum)
    ceiling, largest = optimum.values["ceiling"], recording.largest_command
    rest = _size(model, clipped) / _size(model, prediction)
    if rest > LARGEST_REST or largest - ceiling < SURE_ERRORS * error:
        return prediction
    then = clipped.fits()
    noted = recording.noting(
        f"the drive may clip at {ceiling:.3g} ± {error:.2g} V, below this command of {largest:g} V:"
        f" give --ceiling {ceiling:.3g}; fitted to this recording it would give arm angle "
        f"{then['arm angle']:.1f} %, pendulum angle {then['pendulum angle']:.1f} %"
    )
    return prediction._replace(recording=noted)


def _size(model: Model, prediction: Prediction) -> float:
    """Norm of the prediction's errors, in units of the fit's residuals."""
    errors = (prediction.recording.measured - prediction.predicted) / model.scale
    return float(np.sqrt(np.nansum(errors**2)))


def _fitted(model: Model, prediction: Prediction, known: float) -> Optimum:
    """A fit of the ceiling alone, from the best of several."""
    recording = prediction.recording
    tried = np.log(np.linspace(known, recording.largest_command, TRIED + 2)[1:-1])
    starts = [model.values.changed(["ceiling"], [ceiling]) for ceiling in tried]
    sizes = [_size(model, model._replace(values=start).predict(recording)) for start in starts]
    start = starts[int(np.argmin(sizes))]
    return optimise([recording], ["ceiling"], start, model.window, model.scale, True, FINE)


def _standard_error(model: Model, optimum: Optimum) -> float:
    """Error of the ceiling [V]: that of its fit, and that of the model that predicts."""
    chosen = [k for k, key in enumerate(model.keys) if field_of(key) != "zero"]
    information = optimum.about([model.keys[k] for k in chosen]).blocks.sum(axis=0)
    if not information[0, 0]:
        return float("inf")
    shift = information[0, 1:] / information[0, 0]
    covariance, _ = covariance_and_information(optimum, {})
    variance = covariance[0, 0] + shift @ model.covariance[np.ix_(chosen, chosen)] @ shift
    return float(np.sqrt(variance)) * optimum.values["ceiling"]
