"""Angles in radians, and speeds that are their slopes: found out from the motion itself."""

from __future__ import annotations

import numpy as np

from furuta_identification.regression.momentum import pendulum_misfit
from furuta_identification.regression.speeds import slope_factor, with_speeds
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT
from furuta_recordings.recording import Recording

ANGLES = ("auto", "rad", "deg")
DEGREE = np.pi / 180.0
# How much better the pendulum's equation must hold with degrees for them to be found: a small
# swing is as good in either.
BETTER = 0.5
# Errors of the pendulum's zero [rad] that must not be taken for another unit.
ZEROS = (0.0, -0.4, -0.3, -0.2, -0.1, 0.1, 0.2, 0.3, 0.4)
# Slope of the angle over what is called its speed, by the unit of the latter.
SPEED_UNITS = {"rad/s": 1.0, "deg/s": DEGREE, "rpm": 2.0 * np.pi / 60.0}
# How far a factor may be from a unit's, for noise and ripples.
ALIKE = 0.15


def in_radians(recording: Recording, angles: str) -> tuple[Recording, list[str]]:
    """The recording with unwrapped angles in rad; ``angles`` says their unit, or auto."""
    candidates = {"rad": _unwrapped(recording, 1.0), "deg": _unwrapped(recording, DEGREE)}
    if angles != "auto":
        return candidates[angles], [f"angles in {angles} (as given)"] if angles == "deg" else []
    slopes = {unit: _with_slopes(each) for unit, each in candidates.items()}
    limit = pendulum_misfit(slopes["deg"]) / BETTER
    if all(pendulum_misfit(slopes["rad"].reoriented(zero, 1.0, 1.0)) > limit for zero in ZEROS):
        return candidates["deg"], ["angles in deg (found)"]
    return candidates["rad"], []


def _unwrapped(recording: Recording, unit: float) -> Recording:
    measured = recording.measured.copy()
    for angle in (PHI, THETA):
        measured[:, angle] = np.unwrap(unit * measured[:, angle])
    return recording._replace(measured=measured)


def _with_slopes(recording: Recording) -> Recording:
    """With the angles' slopes for speeds."""
    measured = recording.measured.copy()
    measured[:, [PHI_DOT, THETA_DOT]] = np.nan
    return with_speeds(recording._replace(measured=measured), 0.0)


def with_true_speeds(recording: Recording) -> tuple[Recording, list[str]]:
    """The recording with speeds in rad/s, without those that are not the slopes of the angles."""
    measured, findings = recording.measured.copy(), []
    for angle, speed, name in ((PHI, PHI_DOT, "arm"), (THETA, THETA_DOT, "pendulum")):
        factor = slope_factor(recording, angle, speed)
        if factor is None:
            continue
        unit, size = min(SPEED_UNITS.items(), key=lambda each: abs(abs(factor) / each[1] - 1.0))
        if abs(abs(factor) / size - 1.0) > ALIKE:
            measured[:, speed] = np.nan
            findings.append(
                f"the {name}'s speed is not the slope of its angle, which is {factor:.3g} times as "
                "large: left out"
            )
        elif unit != "rad/s" or factor < 0.0:
            measured[:, speed] *= np.sign(factor) * size
            turned = ", counted the other way than its angle" if factor < 0.0 else ""
            findings.append(f"the {name}'s speed is in {unit}{turned} (found)")
    return recording._replace(measured=measured), findings
