r"""The pendulum's own motion, from swings while the arm is held and the motor is not driven.

With the arm at rest, (1) is

.. math::
    θ̈ = ω_0^2 \sinθ - c θ̇ - f \,\mathrm{sign}\,θ̇, \qquad ω_0^2 = δ/β

so such recordings determine the natural frequency and the friction of the pendulum's joint, each
divided by β. They say nothing about the arm.
"""

from typing import Any, NamedTuple

import numpy as np

from furuta_identification.model import Prediction
from furuta_identification.options import Options
from furuta_identification.preparation.angles import (
    angle_unit,
    in_unit,
    oriented,
    with_usable_speeds,
)
from furuta_identification.regression.pendulum_motion import pendulum_motion
from furuta_identification.shooting.optimisation import (
    FINE,
    Optimum,
    noise_of,
    optimise,
    quantisation_step,
    residual_scale,
)
from furuta_identification.shooting.unknowns import ParameterValues
from furuta_identification.uncertainty.covariance import covariance_and_information
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, THETA
from furuta_recordings.cleaning import cleaned
from furuta_recordings.recording import Recording

# The scale β [V s²/rad], which the motion does not show: that of a small rig, so that priors suit.
SCALE = 0.0025
# Inertia of a held arm [V s²/rad], and the coupling to it.
HELD, COUPLING = 1e6, 1e-6
# Motion of the arm as a part of the pendulum's, at which the frequency errs by 0.1 %.
LARGEST_ARM_PART = 0.003
# Lengths of the first segments [s]; the last ones are halves, whose states at the start are fitted.
FIRST_LENGTHS = (1.0, 3.0)
UNKNOWNS = ["delta", "pendulum_viscous", "pendulum_coulomb", "zero"]
NATURAL_FREQUENCY, DAMPING, FRICTION = (
    "natural_frequency_rad_s",
    "pendulum_damping_1_s",
    "pendulum_friction_rad_s2",
)


class FreeSwing(NamedTuple):
    """Values and standard errors by name, fit of the angle [%] by recording, and findings.

    The names are those of ω₀ [rad/s], c [1/s] and f [rad/s²].
    """

    values: dict[str, float]
    standard_errors: dict[str, float]
    fit: dict[str, float]
    findings: list[str]

    def as_json(self) -> dict[str, Any]:
        """The values by name, and the rest."""
        others = {"standard_errors": self.standard_errors, "fit": self.fit}
        return {**self.values, **others, "findings": self.findings}


def identify_free_swing(recordings: list[Recording], options: Options) -> FreeSwing:
    """Fit recordings of one rig without a command; raises ParameterError if the arm moves."""
    ready, findings = _prepared(recordings, options)
    gravity = float(np.median([pendulum_motion(recording).gravity for recording in ready]))
    values = ParameterValues.of(
        arm_inertia=HELD, beta=SCALE, gamma=COUPLING, delta=gravity * SCALE, coulomb=0.0, lag=0.0
    )
    scale = np.median([noise_of(recording) for recording in ready], axis=0)
    half = 0.5 * min(recording.duration for recording in ready)
    for window in (*FIRST_LENGTHS, half):
        length = min(window, half)
        optimum = optimise(ready, UNKNOWNS, values, length, scale, robust=True)
        values, scale = optimum.values, residual_scale(optimum)
    optimum = optimise(ready, UNKNOWNS, values, half, scale, robust=True, tolerance=FINE)
    predictions = optimum.shooting.predictions(optimum.vector)
    fits = {
        recording.name: Prediction(recording, predicted).fits()["pendulum angle"]
        for recording, predicted in zip(ready, predictions, strict=True)
    }
    return FreeSwing(*_reported(optimum), fits, findings)


def _prepared(recordings: list[Recording], options: Options) -> tuple[list[Recording], list[str]]:
    """The recordings in SI units, with θ = 0 upright. The angle's direction does not matter."""
    usable, findings = [], []
    for recording in recordings:
        ready, remarks = cleaned(recording, driven=False)
        _refuse_moving_arm(ready)
        usable.append(_with_resting_arm(ready))
        findings += [f"{recording.name}: {remark}" for remark in remarks]
    angles, remarks = angle_unit(usable, options.angles)
    findings += remarks
    swinging = []
    for number, recording in enumerate(usable):
        ready, remarks = with_usable_speeds(in_unit(recording, angles))
        swinging.append(ready._replace(number=number))
        findings += [f"{recording.name}: {remark}" for remark in remarks]
    turned, _, remarks = oriented(swinging, options, 1.0)
    return turned, [*findings, *remarks]


def _refuse_moving_arm(recording: Recording) -> None:
    arm, pendulum = (float(np.ptp(recording.measured[:, angle])) for angle in (PHI, THETA))
    step = quantisation_step(recording.measured[:, PHI])
    if arm > LARGEST_ARM_PART * pendulum + 1.5 * step:
        raise ParameterError(
            f"{recording.name}: the arm moves by {100.0 * arm / pendulum:.2g} % of the pendulum's "
            "motion without a command; hold it, or name the command with --command"
        )


def _with_resting_arm(recording: Recording) -> Recording:
    """The recording with the arm at 0, without commands."""
    measured = recording.measured.copy()
    measured[:, [PHI, PHI_DOT]] = 0.0
    nothing = np.zeros(0)
    return recording._replace(measured=measured, command_time=nothing, command=nothing)


def _reported(optimum: Optimum) -> tuple[dict[str, float], dict[str, float]]:
    """Values and standard errors by name."""
    covariance, _ = covariance_and_information(optimum, {})
    errors = np.sqrt(np.diag(covariance))
    omega = float(np.sqrt(optimum.values["delta"] / SCALE))
    values = {
        NATURAL_FREQUENCY: omega,
        DAMPING: optimum.values["pendulum_viscous"] / SCALE,
        FRICTION: optimum.values["pendulum_coulomb"] / SCALE,
    }
    # δ is fitted as its logarithm.
    sizes = (0.5 * omega, 1.0 / SCALE, 1.0 / SCALE)
    scaled = (float(size * error) for size, error in zip(sizes, errors[: len(sizes)], strict=True))
    return values, dict(zip(values, scaled, strict=True))
