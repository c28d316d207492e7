r"""The pendulum's motion as a regression for its acceleration, in any unit and with any zero.

The pendulum's equation, divided by β and integrated over windows as in
:mod:`furuta.identification.regression.equations`, is

.. math::
    θ̈ = -\frac γβ \frac{d(\cosθ φ̇)}{dt} \Big|_{φ̇} + \sinθ\cosθ φ̇^2 + \frac δβ \sin(θ + ψ) - …

Its left side is measured, so the part of it that remains unexplained compares units and zeros with
each other. ψ, the angle between the measured zero and upright, follows from the coefficients of
sinθ and cosθ; the other terms depend on it too, so it is found by iteration.
"""

from typing import NamedTuple

import numpy as np

from furuta.identification.regression.speeds import REACH, with_speeds
from furuta.identification.regression.windows import WINDOW, Windows, regress
from furuta_model.state import PHI_DOT, THETA_DOT
from furuta_recordings.recording import Recording

# First zeros [rad] of the iteration, and its steps.
FIRST_ZEROS = (0.0, 0.5 * np.pi, np.pi, -0.5 * np.pi)
STEPS = 6
# Ratio of two misfits that is no difference.
SAME = 1.01
# A window is so short that joints turn at most this far in it [rad], but not shorter [s].
LARGEST_TURN, SHORTEST_WINDOW = 3.0, 0.04
# Speed [rad/s] from which windows count less.
FAST = 15.0
# Farthest turn [rad] over which a slope is taken, and slowest motion [rad/s].
LARGEST_STEP, SLOWEST = 0.2, 1e-6


class PendulumMotion(NamedTuple):
    """What the regression finds.

    ``zero`` ψ [rad]: θ = measured + ψ; ``coupling`` γ/β and its standard error; ``gravity`` δ/β
    [1/s²] and its standard error; ``misfit``, the unexplained part of the acceleration, 0 to 1;
    ``samples``, the effective number of windows.
    """

    zero: float
    coupling: float
    coupling_error: float
    gravity: float
    gravity_error: float
    misfit: float
    samples: float


def pendulum_motion(recording: Recording) -> PendulumMotion:
    """The regression for the angles of a recording in rad, with the best of all zeros."""
    angles = recording._replace(measured=recording.measured.copy())
    angles.measured[:, [PHI_DOT, THETA_DOT]] = np.nan
    speeds = with_speeds(angles, 0.0).measured[:, [PHI_DOT, THETA_DOT]]
    # Root mean square of the faster joint's speed [rad/s].
    fastest = max(float(np.sqrt(np.max(np.mean(speeds**2, axis=0)))), SLOWEST)
    moving = with_speeds(angles, 0.0, float(np.clip(LARGEST_STEP / fastest, 0.0, REACH)))
    length = float(np.clip(LARGEST_TURN / fastest, SHORTEST_WINDOW, WINDOW))
    windows = Windows(recording.time, length)
    return min((_from_zero(moving, windows, z) for z in FIRST_ZEROS), key=lambda m: m.misfit)


def _from_zero(recording: Recording, windows: Windows, zero: float) -> PendulumMotion:
    """Iterate from a first ``zero`` [rad]; the last step, or one with a clearly smaller misfit.

    The zero hardly changes the misfit of a slow motion, but gravity is known at the right one only.
    """
    motions = []
    for _ in range(STEPS):
        step, motion = _regression(recording.reoriented(zero, 1.0, 1.0), windows, zero)
        motions.append(motion)
        zero = (zero + step + np.pi) % (2.0 * np.pi) - np.pi
    best = min(motions, key=lambda motion: motion.misfit)
    return motions[-1] if motions[-1].misfit <= SAME * best.misfit else best


def _regression(
    recording: Recording, windows: Windows, zero: float
) -> tuple[float, PendulumMotion]:
    """The error of the ``zero`` [rad] that the recording was rotated by, and the motion."""
    _, v, theta, w = recording.measured.T
    s, c = np.sin(theta), np.cos(theta)
    y = windows.slope(w) - windows.mean(s * c * v * v)
    columns = (
        windows.mean(s),
        windows.mean(c),
        -windows.slope(c * v) - windows.mean(s * v * w),
        -windows.mean(w),
        -windows.mean(np.sign(w)),
    )
    # Errors of the model's fast terms grow with the square of the speed.
    energy = windows.mean(v * v + w * w) / windows.mean(np.ones(len(v)))
    weights = 1.0 / (1.0 + energy / FAST**2)
    fit = regress(weights[:, None] * np.array(columns).T, weights * y)
    gravity, across, coupling = fit.coefficients[:3]
    step = float(np.arctan2(across, gravity))
    if gravity < 0.0:  # it is positive at the opposite zero
        zero += np.pi if zero <= 0.0 else -np.pi
        gravity, coupling = -gravity, -coupling
    errors = fit.errors
    return step, PendulumMotion(
        zero, coupling, errors[2], gravity, errors[0], fit.misfit, fit.samples
    )
