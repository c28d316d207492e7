"""Measures an oscillation sample by sample: peak to peak, period, fraction of time stuck.

A run of any length needs one small memory, :class:`OscillationSums`. It first accumulates the
midpoint of the motion and then everything else. In a run these are two successive parts; a
recorded series is passed twice.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from furuta_model.block import new_memory
from furuta_model.compiled import compiled, inlined
from furuta_model.friction.lugre import highest_level
from furuta_model.friction.parameters import Friction
from furuta_model.state import HORIZONTAL, PHI, PHI_DOT, THETA

# Fraction of the peak-to-peak value by which φ must go below the midpoint between crossings.
HYSTERESIS = 0.1
# Arm speed [rad/s] below which the arm counts as stuck. Under LuGre a stuck arm creeps through the
# deflection of the bristle, 5 mrad in about half a second.
STUCK_SPEED = 1e-2
# Largest level of friction [V] that is none: nothing holds the arm.
FRICTIONLESS = 1e-9
# Friction that holds the arm.
ANY = Friction()
# Peak to peak of the arm [rad] below which there is no period.
SMALLEST_OSCILLATION = 1e-6


@dataclass
class OscillationSums:
    """What is accumulated of an oscillation.

    Attributes:
        midpoint_samples: Samples in the midpoint.
        midpoint_low: Lowest φ that gives the midpoint [rad]; ``midpoint_high``: the highest.
        samples: Samples of the part that is measured.
        stuck: Those in which the arm is stuck.
        phi_low: Lowest φ [rad]; ``phi_high``: the highest; for θ ``theta_low``, ``theta_high``.
        previous_phi: φ of the previous sample [rad].
        was_below: Whether φ has been well below the midpoint since the last upward crossing.
        crossings: Upward crossings of the midpoint.
        first_crossing: Sample of the first one; ``last_crossing``: of the last.
    """

    midpoint_samples: int = 0
    midpoint_low: float = 0.0
    midpoint_high: float = 0.0
    samples: int = 0
    stuck: int = 0
    phi_low: float = 0.0
    phi_high: float = 0.0
    theta_low: float = 0.0
    theta_high: float = 0.0
    previous_phi: float = 0.0
    was_below: bool = False
    crossings: int = 0
    first_crossing: float = 0.0
    last_crossing: float = 0.0


class Oscillation(NamedTuple):
    """Peak to peak [rad], period [s] (NaN without one), fraction of time stuck.

    Where nothing holds the arm, the fraction is NaN.
    """

    phi_peak_to_peak_rad: float
    theta_peak_to_peak_rad: float
    period_s: float
    stuck_fraction: float


@inlined
def accumulate_midpoint(sums: OscillationSums, x: np.ndarray) -> None:
    """Include one sample in the midpoint of the arm's motion."""
    if sums.midpoint_samples == 0:
        sums.midpoint_low = sums.midpoint_high = x[PHI]
    sums.midpoint_low = min(sums.midpoint_low, x[PHI])
    sums.midpoint_high = max(sums.midpoint_high, x[PHI])
    sums.midpoint_samples += 1


@inlined
def accumulate(sums: OscillationSums, x: np.ndarray) -> None:
    """Include the true state ``x`` (4 or more) of one sample, once the midpoint is known."""
    phi, theta = x[PHI], x[THETA]
    if sums.samples == 0:
        sums.phi_low = sums.phi_high = sums.previous_phi = phi
        sums.theta_low = sums.theta_high = theta
    sums.phi_low = min(sums.phi_low, phi)
    sums.phi_high = max(sums.phi_high, phi)
    sums.theta_low = min(sums.theta_low, theta)
    sums.theta_high = max(sums.theta_high, theta)
    if abs(x[PHI_DOT]) < STUCK_SPEED:
        sums.stuck += 1
    _count_crossing(sums, phi)
    sums.previous_phi = phi
    sums.samples += 1


@inlined
def _count_crossing(sums: OscillationSums, phi: float) -> None:
    """Count an upward crossing of the midpoint if φ was well below it before."""
    midpoint = 0.5 * (sums.midpoint_low + sums.midpoint_high)
    before, after = sums.previous_phi - midpoint, phi - midpoint
    if after < -HYSTERESIS * (sums.midpoint_high - sums.midpoint_low):
        sums.was_below = True
    elif before < 0.0 <= after and sums.was_below:
        sums.was_below = False
        sums.last_crossing = sums.samples - 1.0 + before / (before - after)
        if sums.crossings == 0:
            sums.first_crossing = sums.last_crossing
        sums.crossings += 1


def oscillation(sums: OscillationSums, sample_time: float, friction: Friction = ANY) -> Oscillation:
    """The oscillation that was accumulated, with samples every ``sample_time`` [s]."""
    earlier_peak_to_peak = sums.midpoint_high - sums.midpoint_low
    has_period = sums.crossings >= 2 and earlier_peak_to_peak >= SMALLEST_OSCILLATION
    duration = sums.last_crossing - sums.first_crossing
    is_held = highest_level(friction) >= FRICTIONLESS
    period_s = duration / (sums.crossings - 1) * sample_time if has_period else np.nan
    return Oscillation(
        phi_peak_to_peak_rad=sums.phi_high - sums.phi_low,
        theta_peak_to_peak_rad=sums.theta_high - sums.theta_low,
        period_s=period_s,
        stuck_fraction=sums.stuck / max(1, sums.samples) if is_held else np.nan,
    )


def measure_oscillation(state: np.ndarray, sample_time: float) -> Oscillation:
    """Measure the true state (n, 4), sampled every ``sample_time`` [s], without transients."""
    sums = new_memory(OscillationSums)
    _accumulate_series(sums, np.ascontiguousarray(state, dtype=float))
    return oscillation(OscillationSums(*sums[0].item()), sample_time)


@compiled
def _accumulate_series(sums: np.ndarray, state: np.ndarray) -> None:
    for x in state:
        accumulate_midpoint(sums[0], x)
    for x in state:
        accumulate(sums[0], x)


def has_fallen(state: np.ndarray) -> np.ndarray:
    """Where the pendulum is below the horizontal (n,), by its true state (n, 4)."""
    return np.abs(state[:, THETA]) > HORIZONTAL
