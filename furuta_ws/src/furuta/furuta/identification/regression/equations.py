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

from typing import NamedTuple

import numpy as np
from scipy.optimize import nnls

from furuta.identification.regression.speeds import with_speeds
from furuta.identification.regression.windows import (
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


class ArmRows(NamedTuple):
    """Rows of the arm's equation: windows, columns (n, 5), which windows they belong to.

    The columns are those of α, δ, viscous friction, Coulomb level forward and backward, with β and
    γ in units of δ from the coefficients of the ``pendulum``'s equation.
    """

    recording: Recording
    windows: Windows
    pendulum: np.ndarray
    columns: np.ndarray
    moving: np.ndarray

    def commanded(self, recording: Recording) -> np.ndarray:
        """The mean command of each row [V]; one that holds over a sample counts half at its ends.

        It is that of another ``recording`` of the same samples.
        """
        earlier = recording.commanded_at(recording.time - recording.interval)
        mean = self.windows.mean(0.5 * (earlier + recording.commanded_at(recording.time)))
        commanded: np.ndarray = mean[self.moving]
        return commanded


def arm_rows(recording: Recording, rarest: float = LARGEST_SLOW_PART) -> ArmRows:
    """The arm's equation of a recording that has all speeds, where the arm moves.

    Coulomb friction counts if the arm turns in its rarer direction for a part of ``rarest``.
    Otherwise it cannot be distinguished from a smaller voltage and is assumed to be zero.
    """
    windows = Windows(recording.time)
    pendulum = pendulum_equation(recording, windows).coefficients
    _, v, theta, w = recording.measured.T
    s, c = np.sin(theta), np.cos(theta)
    forward, backward, moving = _directions(v, windows, rarest)
    if np.sum(moving) < FEWEST_WINDOWS:
        raise ParameterError(
            f"{recording.name}: the arm moves in {np.sum(moving)} of {len(moving)} windows of "
            f"{WINDOW:g} s, which is too few for a fit; record a motion in which it does not rest"
        )
    columns = [
        -windows.slope(v),
        -windows.slope(pendulum[0] * s * s * v + pendulum[1] * c * w),
        windows.mean(v),
        forward,
        -backward,
    ]
    return ArmRows(recording, windows, pendulum, np.array(columns).T[moving], moving)


def arm_misfits(recording: Recording, delays: np.ndarray) -> np.ndarray:
    """Part of the arm's equation that no coefficients explain, 0 to 1, for each delay [s] (k,)."""
    rows = arm_rows(recording)
    delayed = (recording.with_delayed_command(delay) for delay in delays)
    return np.array([regress(rows.columns, rows.commanded(r)).misfit for r in delayed])


def fitted_ceiling(recordings: list[Recording], lag: float, delay: float) -> float:
    """A first value of the ceiling [V], infinite where the arm's equation shows none.

    All recordings share the coefficients, none of which is negative. Coulomb friction is one of
    them, unless the arm hardly turns in one of the directions.
    """
    delayed = (recording.with_delayed_command(delay) for recording in recordings)
    rows = [arm_rows(with_speeds(recording, lag), 0.0) for recording in delayed]
    x = np.concatenate([row.columns for row in rows])
    turned = np.sum(np.abs(x[:, 3:]), axis=0)
    if np.min(turned) < LARGEST_SLOW_PART * np.sum(turned):
        x[:, 3:] = 0.0

    def misfit(ceiling: float) -> float:
        u = np.concatenate([row.commanded(row.recording.with_ceiling(ceiling)) for row in rows])
        return float(nnls(x, u)[1] / np.linalg.norm(u))

    ceilings = PARTS * max(row.recording.largest_command for row in rows)
    misfits = [misfit(ceiling) for ceiling in ceilings]
    best, without = int(np.argmin(misfits)), misfit(np.inf)
    # Windows overlap by half, so every other one counts.
    sure = 0.5 * len(x) * np.log(without / misfits[best]) >= SURE
    return float(ceilings[best]) if sure else float(np.inf)


def _directions(
    v: np.ndarray, windows: Windows, rarest: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How much of each window the arm turns forward and backward, and whether it keeps moving."""
    forward, backward = windows.mean(1.0 * (v > SLOW)), windows.mean(1.0 * (v < -SLOW))
    whole = windows.mean(np.ones(len(v)))
    moving = forward + backward > (1.0 - LARGEST_SLOW_PART) * whole
    rarer = min(np.sum(forward[moving]), np.sum(backward[moving]))
    if rarer < rarest * np.sum(whole[moving]):
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
