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
# Factor between the command scales of recordings from which they have different units, and standard
# errors that make it sure.
OTHER_SCALE, SURE_ERRORS = 1.3, 3.0
# Part of the largest command within which all others are of the same level.
SAME_LEVEL = 0.05


def arm_misfits(recording: Recording, delays: np.ndarray) -> np.ndarray:
    """Part of the arm's equation that no coefficients explain, 0 to 1, for each delay [s] (k,)."""
    windows = Windows(recording.time)
    beta, gamma = pendulum_equation(recording, windows).coefficients[:2]
    x, moving = _arm_columns(recording, windows, beta, gamma)
    delayed = (recording.with_delayed_command(delay) for delay in delays)
    return np.array([regress(x, mean_command(r, windows)[moving]).misfit for r in delayed])


def pendulum_equation(recording: Recording, windows: Windows) -> LinearFit:
    """β/δ, γ/δ, the joint's viscous/δ and Coulomb/δ friction, then zero and tilt."""
    phi, v, theta, w = recording.measured.T
    s, c = np.sin(theta), np.cos(theta)
    columns = [
        windows.slope(w) - windows.mean(s * c * v * v),
        windows.slope(c * v) + windows.mean(s * v * w),
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
    return regress(x, mean_command(recording, windows)[moving])


class ArmRows(NamedTuple):
    """Rows of a recording's arm equation: windows, columns (n, 5), which windows they belong to."""

    recording: Recording
    windows: Windows
    columns: np.ndarray
    moving: np.ndarray

    def commanded(self, ceiling: float = np.inf) -> np.ndarray:
        """The mean command of each row [V], limited by a ceiling."""
        return mean_command(self.recording.with_ceiling(ceiling), self.windows)[self.moving]


def arm_rows(recordings: list[Recording], lag: float, delay: float) -> list[ArmRows]:
    """The arm's equation of recordings that share all coefficients.

    Coulomb friction is one of them, unless the arm hardly turns in one of the directions.
    """
    rows = []
    for recording in recordings:
        ready = with_speeds(recording.with_delayed_command(delay), lag)
        windows = Windows(ready.time)
        beta, gamma = pendulum_equation(ready, windows).coefficients[:2]
        rows.append(ArmRows(ready, windows, *_arm_columns(ready, windows, beta, gamma, 0.0)))
    turned = np.sum([np.sum(np.abs(row.columns[:, 3:]), axis=0) for row in rows], axis=0)
    if np.min(turned) < LARGEST_SLOW_PART * np.sum(turned):
        for row in rows:
            row.columns[:, 3:] = 0.0
    return rows


def fitted_ceiling(rows: list[ArmRows]) -> tuple[float, float]:
    """A first value of the ceiling [V], infinite where the arm's equation shows none; its misfit.

    All recordings share the coefficients, none of which is negative.
    """
    x = np.concatenate([row.columns for row in rows])

    def misfit(ceiling: float) -> float:
        u = np.concatenate([row.commanded(ceiling) for row in rows])
        return float(nnls(x, u)[1] / np.linalg.norm(u))

    ceilings = PARTS * max(row.recording.largest_command for row in rows)
    misfits = [misfit(ceiling) for ceiling in ceilings]
    best, without = int(np.argmin(misfits)), misfit(np.inf)
    # Windows overlap by half, so every other one counts.
    sure = 0.5 * len(x) * np.log(without / misfits[best]) >= SURE
    return (float(ceilings[best]), misfits[best]) if sure else (float(np.inf), without)


class CommandScale(NamedTuple):
    """A recording's command of 1 in commands of the others, its error; the misfit with it."""

    name: str
    factor: float
    error: float
    misfit: float

    @property
    def differs(self) -> bool:
        """Whether the unit or the sign is surely another one."""
        same = 1.0 / OTHER_SCALE < self.factor < OTHER_SCALE
        return not same and min(abs(self.factor), abs(self.factor - 1.0)) > SURE_ERRORS * self.error


def command_scales(rows: list[ArmRows]) -> list[CommandScale]:
    """The command scale of each run, if all others have one; of a single run none."""
    numbers = sorted({row.recording.number for row in rows})
    return [_command_scale(rows, number) for number in numbers if len(numbers) > 1]


def _command_scale(rows: list[ArmRows], number: int) -> CommandScale:
    own = np.concatenate([np.full(len(r.columns), r.recording.number == number) for r in rows])
    u = np.concatenate([row.commanded() for row in rows])
    x = np.column_stack((np.concatenate([row.columns for row in rows]), np.where(own, -u, 0.0)))
    fit = regress(x, np.where(own, 0.0, u))
    factor, error = float(fit.coefficients[-1]), float(fit.errors[-1])
    size = np.linalg.norm(np.where(own, factor * u, u))
    name = next(row.recording.name for row in rows if row.recording.number == number)
    others = np.linalg.norm(u[~own])
    return CommandScale(name, factor, error, float(fit.misfit * others / size))


def mean_command(recording: Recording, windows: Windows) -> np.ndarray:
    """The mean command of each window [V]; one that holds over a sample counts half at its ends."""
    earlier = recording.commanded_at(recording.time - recording.interval)
    return windows.mean(0.5 * (earlier + recording.commanded_at(recording.time)))


def _arm_columns(
    recording: Recording,
    windows: Windows,
    beta: float,
    gamma: float,
    rarest: float = LARGEST_SLOW_PART,
) -> tuple[np.ndarray, np.ndarray]:
    """The columns of the arm's equation in the windows in which it moves, and which these are.

    Coulomb friction counts if the arm turns in its rarer direction for a part of ``rarest``.
    """
    _, v, theta, w = recording.measured.T
    s, c = np.sin(theta), np.cos(theta)
    forward, backward, moving = _directions(v, windows, rarest)
    columns = [
        windows.slope(v),
        windows.slope(beta * s * s * v + gamma * c * w),
        windows.mean(v),
        forward,
        -backward,
    ]
    if np.sum(moving) < FEWEST_WINDOWS:
        raise ParameterError(
            f"{recording.name}: the arm moves in {np.sum(moving)} of {len(moving)} windows of "
            f"{WINDOW:g} s, which is too few for a fit; record a motion in which it does not rest"
        )
    return np.array(columns).T[moving], moving


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
