r"""The equations of arm and pendulum in momenta, as linear regressions.

Lagrange's equations of (1) are linear in the model's coefficients. Multiplied by a bump ψ(t) that
is zero, with its slope, at both ends of a window, and integrated by parts, they need no second
derivative of noisy data:

.. math::
    -\intψ̇\,p_φ = \intψ\,(u - F), \qquad
    -\intψ̇\,p_θ - \intψ\,∂T/∂θ = \intψ\,(δ\sinθ - F_θ)

with momenta p_φ = (α + β sin²θ)φ̇ + γ cosθ θ̇ and p_θ = βθ̇ + γ cosθ φ̇. Each window is one row.
The pendulum's equation, divided by δ, gives the ratios β/δ and γ/δ and the pendulum's zero. The
arm's equation gives the rest in volts.
"""

import numpy as np
from scipy.optimize import nnls

from furuta_identification.regression.speeds import with_speeds
from furuta_identification.regression.windows import (
    FEWEST_WINDOWS,
    WINDOW,
    LinearFit,
    Windows,
    regress,
)
from furuta_model.parameters import ParameterError
from furuta_recordings.recording import Recording

# Arm speed [rad/s] below which friction is not determined by the speed, and the largest part of a
# window that may be so slow.
SLOW = 0.05
LARGEST_SLOW_PART = 0.05
# Ceilings that are tried, as parts of the largest command.
PARTS = np.linspace(0.3, 0.98, 35)
# Logarithm of the likelihood ratio from which a ceiling is there.
SURE = 10.0
# Part of the largest command within which all others are of the same level.
SAME_LEVEL = 0.05


def arm_misfits(recording: Recording, delays: np.ndarray) -> np.ndarray:
    """Part of the arm's equation that no coefficients explain, 0 to 1, for each delay [s] (k,)."""
    windows = Windows(recording.time)
    beta, gamma = pendulum_equation(recording, windows).coefficients[:2]
    x, moving = _arm_columns(recording, windows, beta, gamma)
    delayed = (recording.with_delayed_command(delay) for delay in delays)
    return np.array([regress(x, _commanded(r, windows)[moving]).misfit for r in delayed])


def pendulum_equation(recording: Recording, windows: Windows) -> LinearFit:
    """β/δ, γ/δ, the joint's viscous/δ and Coulomb/δ friction, then zero and tilt."""
    phi, v, theta, w = recording.measured.T
    s, c = np.sin(theta), np.cos(theta)
    columns = [
        -windows.slope(w) - windows.mean(s * c * v * v),
        -windows.slope(c * v) + windows.mean(s * v * w),
        windows.mean(w),
        windows.mean(np.sign(w)),
        -windows.mean(c),
    ]
    if np.ptp(phi) > 1.0:
        columns += [-windows.mean(c * np.sin(phi)), windows.mean(c * np.cos(phi))]
    return regress(np.array(columns).T, windows.mean(s))


def arm_equation(recording: Recording, windows: Windows, beta: float, gamma: float) -> LinearFit:
    """α, δ, viscous friction, Coulomb level forward and backward, with β and γ in units of δ.

    Windows in which the arm rests do not count. If the arm always turned in one direction, its
    Coulomb friction cannot be distinguished from a smaller voltage and is assumed to be zero.
    """
    x, moving = _arm_columns(recording, windows, beta, gamma)
    return regress(x, _commanded(recording, windows)[moving])


def fitted_ceiling(recordings: list[Recording], lag: float, delay: float) -> float:
    """A first value of the ceiling [V], infinite where the arm's equation shows none.

    All recordings share the coefficients, none of which is negative.
    """
    parts = []
    for recording in recordings:
        ready = with_speeds(recording.with_delayed_command(delay), lag)
        windows = Windows(ready.time)
        beta, gamma = pendulum_equation(ready, windows).coefficients[:2]
        parts.append((ready, windows, *_arm_columns(ready, windows, beta, gamma)))
    x = np.concatenate([columns for _, _, columns, _ in parts])

    def misfit(ceiling: float) -> float:
        u = [_commanded(r.with_ceiling(ceiling), windows)[on] for r, windows, _, on in parts]
        both = np.concatenate(u)
        return float(nnls(x, both)[1] / np.linalg.norm(both))

    ceilings = PARTS * max(recording.largest_command for recording in recordings)
    misfits = [misfit(ceiling) for ceiling in ceilings]
    best = int(np.argmin(misfits))
    # Windows overlap by half, so every other one counts.
    sure = 0.5 * len(x) * np.log(misfit(np.inf) / misfits[best]) >= SURE
    return float(ceilings[best]) if sure else float(np.inf)


def _commanded(recording: Recording, windows: Windows) -> np.ndarray:
    """The mean command of each window [V]; one that holds over a sample counts half at its ends."""
    earlier = recording.commanded_at(recording.time - recording.interval)
    return windows.mean(0.5 * (earlier + recording.commanded_at(recording.time)))


def _arm_columns(
    recording: Recording, windows: Windows, beta: float, gamma: float
) -> tuple[np.ndarray, np.ndarray]:
    """The columns of the arm's equation in the windows in which it moves, and which these are."""
    _, v, theta, w = recording.measured.T
    s, c = np.sin(theta), np.cos(theta)
    forward, backward, moving = _directions(v, windows)
    columns = [
        -windows.slope(v),
        -windows.slope(beta * s * s * v + gamma * c * w),
        windows.mean(v),
        forward,
        -backward,
    ]
    if np.sum(moving) < FEWEST_WINDOWS:
        raise ParameterError(
            f"the arm moves in {np.sum(moving)} of {len(moving)} windows of {WINDOW:g} s, which is "
            "too few for a fit; record a motion in which it does not rest"
        )
    return np.array(columns).T[moving], moving


def _directions(v: np.ndarray, windows: Windows) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How much of each window the arm turns forward and backward, and whether it keeps moving."""
    forward, backward = windows.mean(1.0 * (v > SLOW)), windows.mean(1.0 * (v < -SLOW))
    whole = windows.mean(np.ones(len(v)))
    moving = forward + backward > (1.0 - LARGEST_SLOW_PART) * whole
    rarer = min(np.sum(forward[moving]), np.sum(backward[moving]))
    if rarer < LARGEST_SLOW_PART * np.sum(whole[moving]):
        return np.zeros_like(forward), np.zeros_like(backward), moving
    return forward, backward, moving


def has_one_level(recordings: list[Recording]) -> bool:
    """Whether all commands are of one size, such as a step: then no ceiling can be found.

    A drive that reaches a part of the command only and a rig whose inertias and friction are larger
    in proportion give the same motion.
    """
    sizes = np.abs(np.concatenate([r.command for r in recordings]))
    largest = float(np.max(sizes))
    return bool(np.all((sizes == 0.0) | (sizes > (1.0 - SAME_LEVEL) * largest)))
