"""Fit of a pendulum that was balanced upright: short stretches, with the bristle's friction."""

from __future__ import annotations

import numpy as np

from furuta_identification.fitting.model import Model
from furuta_identification.fitting.optimisation import NEAR, optimise
from furuta_identification.preparation.preparation import Options
from furuta_identification.regression.momentum import MomentumFit
from furuta_identification.shooting.unknowns import BODY, LUGRE, Guess
from furuta_identification.uncertainty.sensing import noise_of
from furuta_identification.uncertainty.uncertainty import uncertainty
from furuta_model.state import PHI
from furuta_recordings.recording import Recording

# Stretch [s] that is short against the unstable pole, and one long against noise.
SHORT = 0.5
# Arm travel [rad] from which a tilted base shows.
TRAVEL = 1.0
# A lag longer than this many samples is one; a shorter one may be the sampling itself.
LAGGING = 3.0


def fit_balanced(
    recordings: list[Recording],
    guess: Guess,
    regression: MomentumFit,
    findings: list[str],
    options: Options,
) -> Model:
    """Fit stretches, the states at their starts unknown."""
    window = options.window or SHORT
    scale = np.median([noise_of(each) for each in recordings], axis=0)
    names = [*BODY, "viscous", "coulomb", "asymmetry", "zero"]
    if guess["lag"] > LAGGING * recordings[0].interval:
        names.append("lag")
    else:
        guess = guess.changed(["lag"], [0.0])
    if all(np.ptp(each.measured[:, PHI]) > TRAVEL for each in recordings):
        names += ["tilt_x", "tilt_y"]
    guess = optimise(recordings, names, guess, 0.2 * window, scale, tolerance=NEAR).guess
    names += LUGRE
    guess = optimise(recordings, names, guess, 0.5 * window, scale, tolerance=NEAR).guess
    names.append("delay")
    fitted = optimise(recordings, names, guess, window, scale, tolerance=NEAR)
    delay, error = (
        fitted.guess["delay"],
        np.sqrt(uncertainty(fitted.shooting, fitted.vector, {})[0][-1, -1]),
    )
    guess = fitted.guess
    if abs(delay) < max(3.0 * error, 0.5 * recordings[0].interval):
        findings.append(f"no delay of the command: {delay * 1e3:.3f} ms, taken for none")
        names.remove("delay")
        guess = guess.changed(["delay"], [0.0])
    fitted = optimise(recordings, names, guess, window, scale)
    covariance, information = uncertainty(fitted.shooting, fitted.vector, {})
    return Model(
        fitted.guess,
        names,
        covariance,
        information,
        window,
        scale,
        regression,
        recordings,
        findings,
    )
