"""Detects the units of angles and speeds from the motion and converts them to rad and rad/s."""

from __future__ import annotations

import numpy as np

from furuta_identification.preparation.options import ANGLE_UNITS
from furuta_identification.regression.equations import pendulum_misfit
from furuta_identification.regression.speeds import slope_factor, with_speeds
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT
from furuta_recordings.recording import Recording

DEGREE = np.pi / 180.0
AUTO, RADIANS, DEGREES = ANGLE_UNITS
# The misfit in degrees must be below this part of the misfit in radians before degrees are
# assumed: a small swing fits almost equally well in either.
LARGEST_MISFIT_RATIO = 0.5
# Errors of the pendulum's zero [rad] that must not be mistaken for another unit.
ZERO_ERRORS = (0.0, -0.4, -0.3, -0.2, -0.1, 0.1, 0.2, 0.3, 0.4)
# Slope of the angle [rad/s] at a speed of 1, by the unit of the speed.
SPEED_UNITS = {"rad/s": 1.0, "deg/s": DEGREE, "rpm": 2.0 * np.pi / 60.0}
# Largest relative difference between a measured factor and a unit's, due to noise and ripple.
LARGEST_UNIT_ERROR = 0.15


def in_radians(recording: Recording, angles: str) -> tuple[Recording, list[str]]:
    """The recording with unwrapped angles in rad; ``angles`` is their unit, or auto.

    A unit that the recording names itself counts more.
    """
    candidates = {RADIANS: _unwrapped(recording, 1.0), DEGREES: _unwrapped(recording, DEGREE)}
    if recording.in_radians:
        return candidates[RADIANS], []
    if angles != AUTO:
        findings = [f"angles in {DEGREES} (as given)"] if angles == DEGREES else []
        return candidates[angles], findings
    slopes = {unit: _with_slopes(each) for unit, each in candidates.items()}
    limit = pendulum_misfit(slopes[DEGREES]) / LARGEST_MISFIT_RATIO
    misfits = (
        pendulum_misfit(slopes[RADIANS].reoriented(error, 1.0, 1.0)) for error in ZERO_ERRORS
    )
    if all(misfit > limit for misfit in misfits):
        return candidates[DEGREES], [f"angles in {DEGREES} (detected)"]
    return candidates[RADIANS], []


def _unwrapped(recording: Recording, unit: float) -> Recording:
    measured = recording.measured.copy()
    for angle in (PHI, THETA):
        measured[:, angle] = np.unwrap(unit * measured[:, angle])
    return recording._replace(measured=measured)


def _with_slopes(recording: Recording) -> Recording:
    """With the slopes of the angles instead of the measured speeds."""
    measured = recording.measured.copy()
    measured[:, [PHI_DOT, THETA_DOT]] = np.nan
    return with_speeds(recording._replace(measured=measured), 0.0)


def with_usable_speeds(recording: Recording) -> tuple[Recording, list[str]]:
    """The recording with speeds in rad/s; speeds that do not match the angles become NaN."""
    measured, findings = recording.measured.copy(), []
    for angle, speed, name in ((PHI, PHI_DOT, "arm"), (THETA, THETA_DOT, "pendulum")):
        factor = slope_factor(recording, angle, speed)
        if factor is None:
            continue
        unit, size = min(SPEED_UNITS.items(), key=lambda each: abs(abs(factor) / each[1] - 1.0))
        if abs(abs(factor) / size - 1.0) > LARGEST_UNIT_ERROR:
            measured[:, speed] = np.nan
            findings.append(
                f"the {name}'s speed is not the slope of its angle, which is {factor:.3g} times "
                "as large: ignored"
            )
        elif unit != "rad/s" or factor < 0.0:
            measured[:, speed] *= np.sign(factor) * size
            sign = " and has the opposite sign of its angle" if factor < 0.0 else ""
            findings.append(f"the {name}'s speed is in {unit}{sign} (detected)")
    return recording._replace(measured=measured), findings
