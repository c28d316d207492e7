"""Decides the units of angles and speeds from the motion and converts them to rad and rad/s."""

import numpy as np

from furuta_identification.options import ANGLE_UNITS
from furuta_identification.regression.pendulum_motion import pendulum_motion
from furuta_identification.regression.speeds import slope_factor
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT
from furuta_recordings.recording import Recording

DEGREE = np.pi / 180.0
AUTO, RADIANS, DEGREES = ANGLE_UNITS
# Logarithm of the odds from which a unit is decided (100 to 1), of radians against degrees before
# anything is known (20 to 1), and once more if in degrees the rig would hardly move.
SURE, USUAL, SLIGHT_MOTION = 4.6, 3.0, 3.0
# Swing of the pendulum [rad], peak to peak, that is hardly a motion.
SLIGHT_SWING = 0.5 * DEGREE
# Slope of the angle [rad/s] at a speed of 1, by the unit of the speed.
SPEED_UNITS = {"rad/s": 1.0, "deg/s": DEGREE, "rpm": 2.0 * np.pi / 60.0}
# Largest relative difference between a measured factor and a unit's, due to noise and ripple.
LARGEST_UNIT_ERROR = 0.15


def angle_unit(recordings: list[Recording], angles: str) -> tuple[str, list[str]]:
    """The unit that the angles of all recordings share, as given or by likelihood; findings.

    The likelihood is that of the pendulum's accelerations: gravity's torque depends on the sine of
    the angle. A small swing fits almost equally well in either unit.
    """
    unknown = [recording for recording in recordings if not recording.in_radians]
    if angles != AUTO or not unknown:
        given = angles == DEGREES and bool(unknown)
        findings = [f"angles in {DEGREES} (as given)"] if given else []
        return (RADIANS if angles == AUTO else angles), findings
    odds = USUAL + sum(_log_odds_of_radians(recording) for recording in unknown)
    if abs(odds) < SURE:
        raise ParameterError(
            f"{', '.join(r.name for r in unknown)}: the motion does not tell whether angles "
            f"are in {RADIANS} or {DEGREES}; give their unit with --angles"
        )
    return (RADIANS, []) if odds > 0.0 else (DEGREES, [f"angles in {DEGREES} (detected)"])


def _log_odds_of_radians(recording: Recording) -> float:
    """Logarithm of the odds that angles are in rad rather than in degrees."""
    radians = pendulum_motion(in_unit(recording, RADIANS))
    degrees = in_unit(recording, DEGREES)
    motion = pendulum_motion(degrees)
    samples = min(radians.samples, motion.samples)
    odds = samples * float(np.log(motion.misfit / radians.misfit))
    return odds + (SLIGHT_MOTION if np.ptp(degrees.measured[:, THETA]) < SLIGHT_SWING else 0.0)


def in_unit(recording: Recording, unit: str) -> Recording:
    """The recording with unwrapped angles in rad; a unit that the recording names counts more."""
    size = DEGREE if unit == DEGREES and not recording.in_radians else 1.0
    measured = recording.measured.copy()
    for angle in (PHI, THETA):
        measured[:, angle] = np.unwrap(size * measured[:, angle])
    return recording._replace(measured=measured)


def with_usable_speeds(recording: Recording) -> tuple[Recording, list[str]]:
    """The recording with speeds in rad/s; speeds that do not match the angles become NaN."""
    measured, findings = recording.measured.copy(), []
    for angle, speed, name in ((PHI, PHI_DOT, "arm"), (THETA, THETA_DOT, "pendulum")):
        factor = slope_factor(recording, angle, speed)
        if factor is None:
            continue
        unit, size = min(SPEED_UNITS.items(), key=lambda unit: abs(abs(factor) / unit[1] - 1.0))
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
