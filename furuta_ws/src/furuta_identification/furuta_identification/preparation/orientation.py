"""Finds zero and direction of the pendulum's angle from the motion."""

from __future__ import annotations

import numpy as np

from furuta_identification.regression.equations import ratios
from furuta_identification.regression.speeds import speed_lag, with_speeds
from furuta_model.parameters import ParameterError
from furuta_model.state import THETA
from furuta_recordings.recording import Recording


def oriented(recording: Recording, zero: str) -> tuple[Recording, list[str]]:
    """The recording with θ = 0 upright and θ̇ > 0 in the direction of (1).

    The pendulum's equation shows both: with the wrong zero gravity has the wrong sign, with the
    wrong direction the coupling.
    """
    inertia, coupling = ratios(with_speeds(recording, speed_lag(recording)))
    found = "upright" if inertia > 0.0 else "hanging"
    if zero not in ("auto", found):
        raise ParameterError(
            f"{recording.name}: the pendulum's zero is given as {zero}, but it moves as if its "
            f"zero were {found}"
        )
    direction = -1.0 if coupling < 0.0 else 1.0
    turned = recording.reoriented(np.pi if found == "hanging" else 0.0, direction, 1.0)
    turns = 2.0 * np.pi * np.round(np.mean(turned.measured[:, THETA]) / (2.0 * np.pi))
    turned.measured[:, THETA] -= turns
    source = "as given" if zero == found else "detected"
    return turned, [f"pendulum angle 0 is {found} ({source}): θ = {_formula(found, direction)}"]


def _formula(zero: str, direction: float) -> str:
    if zero == "hanging":
        return "π − measured" if direction < 0.0 else "π + measured"
    return "− measured" if direction < 0.0 else "measured"
