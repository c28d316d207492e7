r"""The pendulum's own motion, from swings while the arm rests and the motor is not driven.

With the arm at rest, (1) is

.. math::
    θ̈ = ω_0^2 \sinθ - c θ̇ - f \,\mathrm{sign}\,θ̇, \qquad ω_0^2 = δ/β

so such recordings determine the natural frequency and the friction of the pendulum's joint, each
divided by β. They say nothing about the arm.

The standard errors contain how far large and small swings of every recording, fitted alone, differ
from the common fit beyond their own errors, the error of the recorder's clock, and the motion of
the arm: an arm that moves by −r θ changes ω₀ by the part r γ/(2β), of which γ/β ≈ 1 is assumed.

Only a part of a recording is used. A swing is the motion from one turning point to the next. Its
amplitude A is half the angle between them, which needs no zero. Without friction it takes

.. math::
    T = \frac{2}{ω_0} K(\sin^2(A/2))

with the complete elliptic integral K. The part is the longest run of swings that follow gravity,
with friction as a small disturbance and an arm at rest.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from scipy.special import ellipk

from furuta.identification.errors import noise_of, quantisation_step
from furuta.identification.estimates import Estimates
from furuta.identification.model import Prediction
from furuta.identification.options import Options
from furuta.identification.preparation.angles import AUTO, DEGREES, RADIANS, in_unit
from furuta.identification.result.values import coloured, verdict
from furuta.identification.shooting.optimisation import FINE, Optimum, optimise, residual_scale
from furuta.identification.shooting.unknowns import ParameterValues
from furuta.identification.uncertainty.covariance import (
    covariance_and_information,
    difference_covariance,
)
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT
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
# Largest amplitude [rad]: beyond it the period is more than A²/16 = 6 % longer than that of a small
# swing, so drag of the air, which the model lacks, would change it through the amplitude.
LARGEST = 1.0
# Smallest amplitude [rad], below which the joint's presliding is no longer small beside gravity,
# and steps of the encoder at which quantisation makes 1 % of it.
SMALLEST, STEPS = 0.1, 30.0
# Largest part of the amplitude that friction takes in a swing: above, its law shapes the motion.
# Largest part that errors of the sensor may add; more is a push.
LARGEST_LOSS, LARGEST_GAIN = 0.2, 0.02
# Motion of the arm as a part of the pendulum's, at which the frequency errs by 0.15 %, and motion
# [rad] in a small swing that is the sensor's.
LARGEST_ARM_PART, SMALLEST_ARM_MOTION = 0.003, 0.002
# Largest relative difference of a swing's frequency from the median; a hand or a gap makes more.
LARGEST_DIFFERENCE = 0.1
FEWEST_SWINGS = 8
# Angle [rad] by which the pendulum comes back after a turning point.
DEPTH = 0.5 * SMALLEST


class FreePart(NamedTuple):
    """The usable part: hanging at θ = π, the arm at 0, and no speeds, which may lag.

    ``frequency`` [rad/s] is ω₀ by the formula above, ``middle`` [s] the time at which half of the
    swings are over, ``arm_part`` the arm's motion as a part of the pendulum's.
    """

    recording: Recording
    frequency: float
    middle: float
    arm_part: float


class _Swings(NamedTuple):
    """Times [s] and samples of the turning points (m + 1,), then what each swing (m,) shows.

    That is its amplitude [rad], ω₀ [rad/s] and the motion of the arm [rad].
    """

    time: np.ndarray
    turns: np.ndarray
    amplitude: np.ndarray
    frequency: np.ndarray
    arm: np.ndarray


@dataclass(frozen=True, repr=False, eq=False)
class FreeSwing(Estimates):
    """The pendulum's own motion, divided by β: ω₀ [rad/s], c [1/s] and f [rad/s²].

    ``predictions`` are what is predicted of the recordings.
    """

    predictions: list[Prediction] = field(repr=False)

    details = Estimates.details | {"coloured_percent"}

    def _by_name(self) -> dict[str, Any]:
        """Also the fit of the angle [%]."""
        runs = {run.recording.name: run for run in self.predictions}
        return {
            **super()._by_name(),
            "fit": {name: run.fits()["pendulum angle"] for name, run in runs.items()},
            "coloured_percent": {name: coloured(run) for name, run in runs.items()},
        }

    def plot(self, axes: Any = None) -> Any:
        """Draw the recordings, measured and fitted; see :meth:`Result.plot`."""
        from furuta.figures.residual import draw_residuals

        return draw_residuals(self.predictions, [], axes)


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
    findings = findings_of(ready)
    return FreeSwing(
        *_reported(optimum, parts), {}, {}, verdict(predictions), findings, predictions
    )


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


def free_part(recording: Recording, options: Options) -> FreePart:
    """The part of a cleaned recording that the model explains; raises ParameterError without one.

    Angles are in degrees if that makes several swings large enough: in radians such swings would be
    larger than a turn.
    """
    given = options.angles if options.angles != AUTO else RADIANS if recording.in_radians else AUTO
    units = (DEGREES, RADIANS) if given == AUTO else (given,)
    for unit in units:
        ready = in_unit(recording, unit)
        swings = _swings(ready)
        first, end = _longest_run(_usable(swings, ready))
        if end - first >= FEWEST_SWINGS:
            return _cut(ready.noting(f"angles in {unit}"), swings, first, end)
    raise ParameterError(f"{recording.name}: {_why(swings)}")


def _swings(recording: Recording) -> _Swings:
    angle, arm = recording.measured[:, THETA], recording.measured[:, PHI]
    index = np.array(_turning_points(angle), dtype=int)
    time = recording.time[index]
    amplitude = 0.5 * np.abs(np.diff(angle[index]))
    frequency = 2.0 * ellipk(np.sin(0.5 * np.minimum(amplitude, 3.0)) ** 2) / np.diff(time)
    moves = [np.ptp(arm[start : end + 1]) for start, end in itertools.pairwise(index)]
    return _Swings(time, index, amplitude, frequency, np.array(moves))


def _turning_points(angle: np.ndarray) -> list[int]:
    """Indices of the extremes of an angle (n,) between which it moves by more than DEPTH."""
    points: list[int] = []
    high = low = 0
    falling = rising = True
    for k, value in enumerate(angle.tolist()):
        high = k if value > angle[high] else high
        low = k if value < angle[low] else low
        if rising and value < angle[high] - DEPTH:
            points.append(high)
            falling, rising, low = True, False, k
        elif falling and value > angle[low] + DEPTH:
            points.append(low)
            falling, rising, high = False, True, k
    return points


def _usable(swings: _Swings, recording: Recording) -> np.ndarray:
    """Which swings the model explains (m,); never the first one, which a hand may have begun."""
    amplitude, frequency = swings.amplitude, swings.frequency
    smallest = max(SMALLEST, STEPS * quantisation_step(recording.measured[:, THETA]))
    usable = (amplitude >= smallest) & (amplitude <= LARGEST)
    usable &= swings.arm <= np.maximum(2.0 * LARGEST_ARM_PART * amplitude, SMALLEST_ARM_MOTION)
    kept = amplitude[1:] / amplitude[:-1]
    usable[1:] &= (kept > 1.0 - LARGEST_LOSS) & (kept < 1.0 + LARGEST_GAIN)
    usable[:1] = False
    if np.any(usable):
        usual = np.median(frequency[usable])
        usable &= np.abs(frequency / usual - 1.0) < LARGEST_DIFFERENCE
    return usable


def _longest_run(usable: np.ndarray) -> tuple[int, int]:
    """Start and end of the longest run of True values (m,)."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], usable.astype(int), [0]))))
    runs = [(int(start), int(end)) for start, end in edges.reshape(-1, 2)]
    return max(runs, key=lambda run: run[1] - run[0], default=(0, 0))


def _why(swings: _Swings) -> str:
    """Why no part of a recording is usable."""
    large = swings.amplitude >= SMALLEST
    ratio = np.median(0.5 * swings.arm[large] / swings.amplitude[large]) if large.any() else 0.0
    if ratio > LARGEST_ARM_PART:
        return (
            f"the arm moves by {100.0 * ratio:.2g} % of the pendulum's motion without a command; "
            "hold it, or name the command with --command"
        )
    return (
        f"{np.sum(large)} swings of at least {SMALLEST:g} rad, but no {FEWEST_SWINGS} free ones in "
        f"a row below {LARGEST:g} rad that lose less than {100.0 * LARGEST_LOSS:g} % each; release "
        f"the pendulum at {LARGEST:g} rad and record until it rests"
    )


def _cut(recording: Recording, swings: _Swings, first: int, end: int) -> FreePart:
    """The swings from ``first`` to before ``end``."""
    points = swings.turns[first : end + 1]
    start, stop, middle = (swings.time[k] for k in (first, end, (first + end) // 2))
    angles = recording.measured[points, THETA]
    centre = float(np.mean(0.5 * (angles[1:] + angles[:-1])))
    amplitude = swings.amplitude[first:end]
    part = recording.between(start, stop).reoriented(np.pi - centre, 1.0, 1.0)
    part.measured[:, [PHI, PHI_DOT]] = 0.0
    part.measured[:, THETA_DOT] = np.nan
    part = part._replace(command_time=np.zeros(0), command=np.zeros(0)).noting(
        f"used from {start:.2f} to {stop:.2f} s of {recording.duration:.2f} s: {end - first} "
        f"swings of {amplitude[0]:.2f} to {amplitude[-1]:.2f} rad"
    )
    arm_part = float(0.5 * swings.arm[first] / amplitude[0])
    return FreePart(part, float(np.median(swings.frequency[first:end])), float(middle), arm_part)
