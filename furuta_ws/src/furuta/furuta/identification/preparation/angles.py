"""Decides units, and zero and direction of the pendulum's angle, from the motion."""

import numpy as np

from furuta.identification.options import ANGLE_UNITS, AUTO_DIRECTION, ZEROS, Options
from furuta.identification.regression.pendulum_motion import PendulumMotion, pendulum_motion
from furuta.identification.regression.speeds import speed_as_slope
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT
from furuta_recordings.recording import Recording, by_run

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
_, UPRIGHT, HANGING = ZEROS
# Standard errors of gravity and of the coupling that make their signs sure.
SURE_SIGN = 3.0
# Largest error [rad] of a zero that is meant to be upright or hanging.
LARGEST_ERROR = 0.5


def angle_unit(recordings: list[Recording], angles: str) -> str:
    """The unit that the angles of all recordings share, as given or by likelihood.

    The likelihood is that of the pendulum's accelerations: gravity's torque depends on the sine of
    the angle. A small swing fits almost equally well in either unit.
    """
    unknown = [recording for recording in recordings if not recording.in_radians]
    if angles != AUTO or not unknown:
        return RADIANS if angles == AUTO else angles
    runs = by_run(unknown)
    each = [sum(map(_log_odds_of_radians, run)) for run in runs]
    (first, *_), (last, *_) = runs[int(np.argmin(each))], runs[int(np.argmax(each))]
    if min(each) + USUAL < -SURE and max(each) + USUAL > SURE:
        raise ParameterError(
            f"{first.name}: its motion shows angles in {DEGREES}, that of {last.name} in {RADIANS};"
            f" name the unit in the columns' names, as in angle [{DEGREES}], or convert one"
        )
    odds = USUAL + sum(each)
    if abs(odds) < SURE:
        raise ParameterError(
            f"{', '.join(r.name for r in unknown)}: the motion does not tell whether angles "
            f"are in {RADIANS} or {DEGREES}; give their unit with --angles"
        )
    return RADIANS if odds > 0.0 else DEGREES


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


def with_usable_speeds(recording: Recording) -> Recording:
    """The recording with speeds in rad/s; speeds that do not match the angles become NaN."""
    measured = recording.measured.copy()
    for angle, speed, name in ((PHI, PHI_DOT, "arm"), (THETA, THETA_DOT, "pendulum")):
        fit = speed_as_slope(recording, angle, speed)
        if fit is None:
            continue
        factor, _ = fit
        unit, size = min(SPEED_UNITS.items(), key=lambda unit: abs(abs(factor) / unit[1] - 1.0))
        if abs(abs(factor) / size - 1.0) > LARGEST_UNIT_ERROR:
            measured[:, speed] = np.nan
            recording = recording.noting(
                f"the {name}'s speed is not the slope of its angle, which is {factor:.3g} times "
                "as large: ignored"
            )
        elif unit != "rad/s" or factor < 0.0:
            measured[:, speed] *= np.sign(factor) * size
            sign = " and has the opposite sign of its angle" if factor < 0.0 else ""
            recording = recording.noting(f"the {name}'s speed is in {unit}{sign} (detected)")
    return recording._replace(measured=measured)


def oriented(
    recordings: list[Recording], options: Options, usual: float
) -> tuple[list[Recording], float]:
    """The recordings with θ = 0 upright and θ̇ > 0 in the direction of (1); and that direction.

    The pendulum's equation shows both: gravity accelerates it away from upright, and the coupling
    to the arm has the sign of the direction. A recording that does not tell its direction has that
    of another one, or else the ``usual`` one.
    """
    motions = [pendulum_motion(recording) for recording in recordings]
    usual = next(filter(None, map(_shown_direction, motions)), usual)
    rotated = []
    for recording, motion in zip(recordings, motions, strict=True):
        direction, source = _direction(recording, motion, options.direction, usual)
        shift, words = _zero(recording, motion, options.zero)
        own = recording.reoriented(direction * shift, direction, 1.0)
        turns = 2.0 * np.pi * np.round(np.mean(own.measured[:, THETA]) / (2.0 * np.pi))
        own.measured[:, THETA] -= turns
        rotated.append(own.noting(f"pendulum angle 0 is {words}, direction {direction:+g}{source}"))
    return rotated, direction


def _shown_direction(motion: PendulumMotion) -> float:
    """Direction of the pendulum's angle, 1 or -1, or 0 if the motion does not tell it."""
    sure = abs(motion.coupling) > SURE_SIGN * motion.coupling_error
    return float(np.sign(motion.coupling)) if sure else AUTO_DIRECTION


def _direction(
    recording: Recording, motion: PendulumMotion, given: float, usual: float
) -> tuple[float, str]:
    """Direction of the pendulum's angle, and its source in words if it is another recording."""
    shown = _shown_direction(motion)
    if given and shown and given != shown:
        raise ParameterError(
            f"{recording.name}: the pendulum's direction is given as {given:g}, but it moves "
            f"as if it were {shown:g}"
        )
    if given or shown:
        return given or shown, ""
    if usual:
        return usual, ", that of the other recordings"
    raise ParameterError(
        f"{recording.name}: the motion does not tell the direction of the pendulum's angle; give "
        "it with --direction (1 or -1), or record a motion in which the arm accelerates more"
    )


def _zero(recording: Recording, motion: PendulumMotion, zero: str | float) -> tuple[float, str]:
    """ψ [rad] of θ = ±(measured + ψ), in words with their source.

    ``zero`` is auto, upright, hanging, or the measured angle [rad] of the hanging pendulum.
    """
    if isinstance(zero, float):
        return np.pi - zero, f"{np.degrees(zero):g}° from hanging (as given)"
    nearest = UPRIGHT if abs(motion.zero) < 0.5 * np.pi else HANGING
    error = abs(motion.zero) if nearest == UPRIGHT else np.pi - abs(motion.zero)
    # Balanced by an arm that moves by less than the sensor's step, the pendulum seems to hang.
    arm_moves = np.isfinite(motion.coupling_error)
    sure = arm_moves and motion.gravity > SURE_SIGN * motion.gravity_error
    known = sure and error < LARGEST_ERROR
    if zero == AUTO and not known:
        raise ParameterError(
            f"{recording.name}: {_doubt(motion, sure)}; give the pendulum's zero with --zero: "
            f"{UPRIGHT}, {HANGING}, or the measured angle of the hanging pendulum in degrees"
        )
    if zero not in (AUTO, nearest) and known:
        raise ParameterError(
            f"{recording.name}: the pendulum's zero is given as {zero}, but it moves as if its "
            f"zero were {nearest}"
        )
    chosen, source = (nearest, "detected") if zero == AUTO else (zero, "as given")
    return (0.0 if chosen == UPRIGHT else np.pi), f"{chosen} ({source})"


def _doubt(motion: PendulumMotion, sure: bool) -> str:
    if not sure:
        return "the motion does not tell where the pendulum's angle is 0"
    hanging = np.degrees((np.pi - motion.zero + np.pi) % (2.0 * np.pi) - np.pi)
    return f"the pendulum seems to hang at a measured angle of {hanging:.0f}°"
