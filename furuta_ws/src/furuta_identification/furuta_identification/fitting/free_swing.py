r"""The pendulum's own motion, from swings while the arm rests and the motor is not driven.

With the arm at rest, (1) is

.. math::
    θ̈ = ω_0^2 \sinθ - c θ̇ - f \,\mathrm{sign}\,θ̇, \qquad ω_0^2 = δ/β

so such recordings determine the natural frequency and the friction of the pendulum's joint, each
divided by β. They say nothing about the arm.

The standard errors contain how far large and small swings of every recording, fitted alone, differ
from the common fit beyond their own errors, the error of the recorder's clock, and the motion of
the arm: an arm that moves by −r θ changes ω₀ by the part r γ/(2β), of which γ/β ≈ 1 is assumed.
"""

from typing import Any, NamedTuple

import numpy as np

from furuta_identification.errors import noise_of
from furuta_identification.model import Prediction
from furuta_identification.options import Options
from furuta_identification.preparation.free_part import FreePart, free_part
from furuta_identification.result.report import verdict
from furuta_identification.shooting.optimisation import (
    FINE,
    Optimum,
    optimise,
    residual_scale,
)
from furuta_identification.shooting.unknowns import ParameterValues
from furuta_identification.uncertainty.covariance import (
    covariance_and_information,
    difference_covariance,
)
from furuta_model.state import PHI, PHI_DOT
from furuta_recordings.cleaning import cleaned
from furuta_recordings.recording import Recording, findings_of

# The scale β [V s²/rad], which the motion does not show: that of a small rig, so that priors suit.
SCALE = 0.0025
# Inertia of a resting arm [V s²/rad], and the coupling to it.
HELD, COUPLING = 1e6, 1e-6
# Lengths of the first segments [s]; the last ones are halves, whose states at the start are fitted.
FIRST_LENGTHS = (1.0, 3.0)
# Error of the recorder's clock as a part of the time: that of a usual crystal.
CLOCK = 1e-4
UNKNOWNS = ["delta", "pendulum_viscous", "pendulum_coulomb", "zero"]


class FreeSwing(NamedTuple):
    """Values and standard errors of ω₀ [rad/s], c [1/s] and f [rad/s²]; and what is predicted."""

    values: dict[str, float]
    standard_errors: dict[str, float]
    predictions: list[Prediction]

    def as_json(self) -> dict[str, Any]:
        """Values by name, standard errors, fit of the angle [%], verdict and findings."""
        return {
            **self.values,
            "standard_errors": self.standard_errors,
            "fit": {p.recording.name: p.fits()["pendulum angle"] for p in self.predictions},
            "verdict": verdict(self.predictions),
            "findings": findings_of([p.recording for p in self.predictions]),
        }


def identify_free_swing(recordings: list[Recording], options: Options) -> FreeSwing:
    """Fit the usable parts of recordings of one rig; raises ParameterError without one."""
    resting = [_with_arm_at_rest(recording) for recording in recordings]
    parts = [free_part(cleaned(recording, driven=False), options) for recording in resting]
    ready = [part.recording for part in parts]
    gravity = float(np.median([part.frequency for part in parts])) ** 2
    values = ParameterValues.of(
        arm_inertia=HELD, beta=SCALE, gamma=COUPLING, delta=gravity * SCALE, coulomb=0.0, lag=0.0
    )
    scale = np.median([noise_of(recording) for recording in ready], axis=0)
    half = 0.5 * min(recording.duration for recording in ready)
    for window in (*FIRST_LENGTHS, half, half):
        length = min(window, half)
        optimum = optimise(ready, UNKNOWNS, values, length, scale, robust=True, tolerance=FINE)
        values, scale = optimum.values, residual_scale(optimum)
    predictions = [Prediction(*pair) for pair in optimum.predictions]
    return FreeSwing(*_reported(optimum, parts), predictions)


def _with_arm_at_rest(recording: Recording) -> Recording:
    """A recording of the pendulum alone, whose angle stands for the arm's too, with an arm."""
    phi, _, theta, _ = recording.measured.T
    if not np.array_equal(phi, theta, equal_nan=True):
        return recording
    measured = recording.measured.copy()
    measured[:, [PHI, PHI_DOT]] = 0.0
    return recording._replace(measured=measured)


def _own_fits(optimum: Optimum, parts: list[FreePart]) -> list[Optimum]:
    """Fits of the large and of the small swings of each recording."""
    start, scale = optimum.values, optimum.scale
    bands = [part.recording.between(-np.inf, part.middle) for part in parts]
    bands += [part.recording.between(part.middle, np.inf) for part in parts]
    return [optimise([b], UNKNOWNS, start, 0.5 * b.duration, scale, True, FINE) for b in bands]


def _reported(optimum: Optimum, parts: list[FreePart]) -> tuple[dict[str, float], dict[str, float]]:
    """Values and standard errors by name."""
    covariance, _ = covariance_and_information(optimum, {})
    covariance += difference_covariance(optimum, _own_fits(optimum, parts), {})
    errors = np.sqrt(np.diag(covariance))
    omega = float(np.sqrt(optimum.values["delta"] / SCALE))
    unseen = omega * np.hypot(CLOCK, 0.5 * max(part.arm_part for part in parts))
    # δ is fitted as its logarithm.
    values = {
        "natural_frequency_rad_s": omega,
        "pendulum_damping_1_s": optimum.values["pendulum_viscous"] / SCALE,
        "pendulum_friction_rad_s2": optimum.values["pendulum_coulomb"] / SCALE,
    }
    sizes = (np.hypot(0.5 * omega * errors[0], unseen), errors[1] / SCALE, errors[2] / SCALE)
    return values, dict(zip(values, map(float, sizes), strict=True))
