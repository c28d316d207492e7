"""Fits a pendulum that was balanced upright: short segments, with the friction of the bristle."""

import numpy as np

from furuta.identification.errors import noise_of
from furuta.identification.model import Model
from furuta.identification.options import Options
from furuta.identification.shooting.optimisation import FINE, optimise
from furuta.identification.shooting.unknowns import BODY, LUGRE, ParameterValues
from furuta.identification.uncertainty.covariance import covariance_and_information
from furuta.identification.unknowns import Key
from furuta_model.state import PHI, THETA
from furuta_recordings.recording import Recording

# Length of a segment [s]: short compared with the unstable pole, long compared with noise.
SEGMENT = 0.5
# Arm travel [rad] from which the effect of a tilted base is visible.
SMALLEST_TRAVEL = 1.0
# Sampling itself can look like a lag of so many samples; a longer one is fitted.
SAMPLES_OF_LAG = 3.0
# Standard errors, and sampling intervals, from which a delay is significant.
DELAY_ERRORS, DELAY_SAMPLES = 3.0, 0.5
# Largest pendulum angle [rad] of a pendulum that was balanced.
LARGEST_ANGLE = 0.7


def is_balanced(recording: Recording) -> bool:
    """Whether the pendulum stays near upright."""
    return bool(np.max(np.abs(recording.measured[:, THETA])) < LARGEST_ANGLE)


def fit_balanced(
    recordings: list[Recording],
    start: ParameterValues,
    findings: list[str],
    options: Options,
) -> Model:
    """Fit segments whose initial states are unknown, growing in length and number of unknowns."""
    window = options.window or SEGMENT
    scale = np.median([noise_of(recording) for recording in recordings], axis=0)
    keys, values = _first_unknowns(recordings, start)
    stage = "fitting segments of a balanced pendulum, step {} of 4"
    options.report(stage.format(1))
    values = optimise(recordings, keys, values, 0.2 * window, scale, False).values
    keys += LUGRE
    options.report(stage.format(2))
    values = optimise(recordings, keys, values, 0.5 * window, scale, False).values
    keys.append("delay")
    options.report(stage.format(3))
    optimum = optimise(recordings, keys, values, window, scale, False)
    values = optimum.values
    error = np.sqrt(covariance_and_information(optimum, {})[0][-1, -1])
    if abs(values["delay"]) < max(DELAY_ERRORS * error, DELAY_SAMPLES * recordings[0].interval):
        milliseconds = values["delay"] * 1e3
        findings.append(f"no significant delay of the command ({milliseconds:.3f} ms): set to zero")
        keys.remove("delay")
        values = values.changed(["delay"], [0.0])
    options.report(stage.format(4))
    optimum = optimise(recordings, keys, values, window, scale, False, FINE)
    options.report("computing standard errors")
    certainty = covariance_and_information(optimum, {})
    return Model(optimum.values, keys, *certainty, window, scale, recordings, findings)


def _first_unknowns(
    recordings: list[Recording], start: ParameterValues
) -> tuple[list[Key], ParameterValues]:
    """Unknowns of the first fit and their values; lag and tilt only where they are visible."""
    keys: list[Key] = [*BODY, "viscous", "coulomb", "asymmetry", "zero"]
    if start["lag"] > SAMPLES_OF_LAG * recordings[0].interval:
        keys.append("lag")
    else:
        start = start.changed(["lag"], [0.0])
    if all(np.ptp(r.measured[:, PHI]) > SMALLEST_TRAVEL for r in recordings):
        keys += ["tilt_x", "tilt_y"]
    return keys, start
