"""Decides zero and direction of the pendulum's angle from the motion."""

import numpy as np

from furuta_identification.options import AUTO_DIRECTION, ZEROS
from furuta_identification.regression.pendulum_motion import PendulumMotion, pendulum_motion
from furuta_model.parameters import ParameterError
from furuta_model.state import THETA
from furuta_recordings.recording import Recording

AUTO, UPRIGHT, HANGING = ZEROS
# Standard errors of gravity and of the coupling that make their signs sure.
SURE = 3.0
# Largest error [rad] of a zero that is meant to be upright or hanging.
LARGEST_ERROR = 0.5


def oriented(
    recording: Recording, zero: str | float, direction: float, usual: float = AUTO_DIRECTION
) -> tuple[Recording, float, list[str]]:
    """The recording with θ = 0 upright and θ̇ > 0 in the direction of (1); direction; findings.

    The pendulum's equation shows both: gravity accelerates it away from upright, and the coupling
    to the arm has the sign of the direction. ``zero`` is auto, upright, hanging, or the measured
    angle [rad] of the hanging pendulum. ``direction`` is 1, −1, or 0 for auto; ``usual`` that of
    other recordings, which counts if the motion does not tell it.
    """
    motion = pendulum_motion(recording)
    direction, remarks = _direction(recording, motion, direction, usual)
    shift, words, source = _zero(recording, motion, zero)
    turned = recording.reoriented(direction * shift, direction, 1.0)
    turns = 2.0 * np.pi * np.round(np.mean(turned.measured[:, THETA]) / (2.0 * np.pi))
    turned.measured[:, THETA] -= turns
    formula = _formula(shift, direction)
    return turned, direction, [f"pendulum angle 0 is {words} ({source}): θ = {formula}", *remarks]


def _direction(
    recording: Recording, motion: PendulumMotion, given: float, usual: float
) -> tuple[float, list[str]]:
    """Direction of the pendulum's angle, and where it is from if not from the motion."""
    measured = -1.0 if motion.coupling < 0.0 else 1.0
    sure = abs(motion.coupling) > SURE * motion.coupling_error
    if given != AUTO_DIRECTION:
        if sure and measured != given:
            raise ParameterError(
                f"{recording.name}: the pendulum's direction is given as {given:g}, but it moves "
                f"as if it were {measured:g}"
            )
        return given, []
    if sure:
        return measured, []
    if usual != AUTO_DIRECTION:
        return usual, ["the pendulum's direction is that of the other recordings"]
    raise ParameterError(
        f"{recording.name}: the motion does not tell the direction of the pendulum's angle; give "
        "it with --direction (1 or -1), or record a motion in which the arm accelerates more"
    )


def _zero(
    recording: Recording, motion: PendulumMotion, zero: str | float
) -> tuple[float, str, str]:
    """ψ [rad] of θ = ±(measured + ψ), in words, and whether it was given."""
    if isinstance(zero, float):
        return np.pi - zero, f"{np.degrees(zero):g}° from hanging", "as given"
    nearest = UPRIGHT if abs(motion.zero) < 0.5 * np.pi else HANGING
    error = abs(motion.zero) if nearest == UPRIGHT else np.pi - abs(motion.zero)
    sure = motion.gravity > SURE * motion.gravity_error
    if zero == AUTO and not (sure and error < LARGEST_ERROR):
        raise ParameterError(
            f"{recording.name}: {_doubt(motion, sure)}; give the pendulum's zero with --zero: "
            f"{UPRIGHT}, {HANGING}, or the measured angle of the hanging pendulum in degrees"
        )
    if zero not in (AUTO, nearest) and sure and error < LARGEST_ERROR:
        raise ParameterError(
            f"{recording.name}: the pendulum's zero is given as {zero}, but it moves as if its "
            f"zero were {nearest}"
        )
    chosen = nearest if zero == AUTO else zero
    source = "detected" if zero == AUTO else "as given"
    return (0.0 if chosen == UPRIGHT else np.pi), str(chosen), source


def _doubt(motion: PendulumMotion, sure: bool) -> str:
    if not sure:
        return "the motion does not tell where the pendulum's angle is 0"
    hanging = np.degrees((np.pi - motion.zero + np.pi) % (2.0 * np.pi) - np.pi)
    return f"the pendulum seems to hang at a measured angle of {hanging:.0f}°"


def _formula(shift: float, direction: float) -> str:
    sign = "− measured" if direction < 0.0 else "measured"
    if shift == 0.0:
        return sign
    start = "π" if shift == np.pi else f"{direction * shift:.4g}"
    return f"{start} {'' if direction < 0.0 else '+ '}{sign}"
