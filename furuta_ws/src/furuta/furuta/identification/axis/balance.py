"""Fits an axis to the balance of its torques, where its motion cannot be predicted from them.

If most of the torque works against friction, as in a slow joint of a robot, small errors of the
torque move a simulated axis far. Its acceleration is then known better than what the torque causes,
and a fit of the motion makes the inertia too large. Here the equation of motion is multiplied by a
bump and integrated by parts, so that torque and acceleration are filtered alike.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from furuta.identification.axis.effects import (
    FALL,
    GRAVITY,
    MOST_WAVES,
    WAVE_BY_CHANCE,
    Group,
    Scales,
    smooth_effects,
    wave_groups,
    waves_of,
)
from furuta.identification.axis.segments import Smoothed, position_noise, smoothed
from furuta.identification.axis.start import SLIDES
from furuta.identification.least_squares import Fit, Linearised, State
from furuta.identification.selection import chance_of
from furuta.identification.unknowns import Key, Unknowns, Values
from furuta_model.state import PHI
from furuta_recordings.recording import Recording

# Shortest and longest bump [s], and noise of the acceleration relative to it that is small: a
# regression makes the inertia too small by the square of it.
SHORTEST, LONGEST, SMALL = 0.2, 1.0, 0.05
# Length [s] of a block of the jackknife, fewest blocks for each unknown, more than a recording has;
# bumps begin by this part of their length apart.
BLOCK, FEWEST_BLOCKS, MANY, APART = 0.5, 2.0, 10**9, 0.25
# Largest probability by chance of an effect: errors of the torque that repeat with the motion look
# like one.
BY_CHANCE = 1e-3
# Unknowns of a fit of the motion that are fitted only if the torques show them.
TESTED = ("delay", "spring", *GRAVITY)
# Usual intervals from which two samples have a gap between them.
GAP = 5.0


class Balance(NamedTuple):
    """A fit of torques, its covariance (p, p) in sizes, and residuals relative to the torque."""

    fit: Fit
    covariance: np.ndarray
    part: float


class Rows(NamedTuple):
    """Columns of the balance by key (n,), torque (n,) and block of each row (n,)."""

    columns: dict[Key, np.ndarray]
    torque: np.ndarray
    block: np.ndarray


class Bump(NamedTuple):
    """Weights of sums that average a series and its first two derivatives."""

    value: np.ndarray
    first: np.ndarray
    second: np.ndarray

    def mean(self, series: np.ndarray) -> np.ndarray:
        """Averages of a series."""
        return np.correlate(series, self.value, "valid")

    def slope(self, series: np.ndarray) -> np.ndarray:
        """Averages of its derivative."""
        return np.correlate(series, self.first, "valid")

    def bend(self, series: np.ndarray) -> np.ndarray:
        """Averages of its second derivative."""
        return np.correlate(series, self.second, "valid")


# The columns of a recording's balance, its torque among them, averaged over bumps.
Columns = Callable[[Bump, Recording, Smoothed], dict[Key, np.ndarray]]


def balanced(recordings: Sequence[Recording], about: Fit, scales: Scales) -> Balance | None:
    """The fit with all effects that the torques support; None if too little of them slides.

    It has no delay, which a slow motion does not show.
    """
    keys = [key for key in about.unknowns.keys if key not in TESTED]
    length = max(bump_length(recording) for recording in recordings)
    rows = sliding_rows(recordings, length, partial(axis_columns, scales))
    if len(np.unique(rows.block)) < FEWEST_BLOCKS * len(keys):
        return None
    singles = ("spring", *smooth_effects(drift=len(recordings) == 1))
    groups: list[Group] = [
        *((name,) for name in singles),
        *((GRAVITY,) if GRAVITY[0] in about.unknowns.keys else ()),
    ]
    absent: list[Key] = [FALL[0], *TESTED]
    values = {**about.values, **dict.fromkeys(absent, 0.0)}
    best = with_effects(rows, fitted_balance(rows, keys, scales, values), scales, groups)
    covered = covariance_with_missed(rows, best, scales, [("delay",), *groups])
    return Balance(best, covered, left_over(rows, best))


def left_over(rows: Rows, best: Fit) -> float:
    """Residuals as a part of the torque."""
    return float(np.std(best.state.residuals) / (np.std(rows.torque) or 1e-300))


def bump_of(length: float, step: float) -> Bump:
    """A bump of a length [s]; as differences its slopes are exactly 0 for a constant."""
    half = max(round(0.5 * length / step), 6)
    value = np.pad((1.0 - np.linspace(-1.0, 1.0, 2 * half + 1) ** 2) ** 4, 1)
    value /= np.sum(value)
    return Bump(value, -np.gradient(value) / step, np.diff(np.pad(value, 1), 2) / step**2)


def bump_length(recording: Recording, shortest: float = SHORTEST, small: float = SMALL) -> float:
    """The shortest length [s] at which the noise of the position hardly changes the inertia."""
    part, length = smoothed(recording), shortest
    position = np.interp(part.time, recording.time, recording.measured[:, PHI])
    while length < LONGEST:
        second = bump_of(length, part.time[1] - part.time[0]).second
        found = np.convolve(position, second, "valid") if len(second) < len(position) else position
        if position_noise(recording) * np.linalg.norm(second) < small * np.std(found):
            break
        length *= 1.5
    return min(length, LONGEST)


def sliding_rows(recordings: Sequence[Recording], length: float, columns: Columns) -> Rows:
    """One row for each bump of a length [s] over which an axis slides in one direction."""
    parts = [smoothed(recording) for recording in recordings]
    slow = SLIDES * max(float(np.max(np.abs(part.speed))) for part in parts)
    gathered, blocks = [], []
    for number, (recording, part) in enumerate(zip(recordings, parts, strict=True)):
        bump = bump_of(length, part.time[1] - part.time[0])
        found = columns(bump, recording, part)
        for other in range(len(parts)):
            found["offset", other] = np.full(len(found["torque"]), float(other == number))
        slides = np.where(np.abs(part.speed) > slow, np.sign(part.speed), 0.0)
        slides *= _has_samples(recording, part.time)
        width = len(bump.value)
        whole = np.abs(np.convolve(slides, np.ones(width), "valid")) > width - 0.5
        whole &= np.arange(len(whole)) % max(int(APART * width), 1) == 0
        gathered.append({name: column[whole] for name, column in found.items()})
        blocks.append(MANY * number + (part.time[: len(whole)][whole] - part.time[0]) // BLOCK)
    joined = {name: np.concatenate([each[name] for each in gathered]) for name in gathered[0]}
    return Rows(joined, joined.pop("torque"), np.concatenate(blocks))


def _has_samples(recording: Recording, time: np.ndarray) -> np.ndarray:
    """Where times lie in no gap."""
    after = np.clip(np.searchsorted(recording.time, time), 1, len(recording.time) - 1)
    has: np.ndarray = np.diff(recording.time)[after - 1] < GAP * recording.interval
    return has


def axis_columns(
    scales: Scales, bump: Bump, recording: Recording, part: Smoothed
) -> dict[Key, np.ndarray]:
    """The torque, and what each unknown of an axis contributes to it, averaged over bumps."""
    mean, torque = bump.mean, recording.commanded_at(part.time)
    q = np.interp(part.time, recording.time, recording.measured[:, PHI])
    speed, side = bump.slope(q), np.sign(mean(part.speed))
    return {
        "torque": mean(torque),
        "inertia": bump.bend(q),
        "alpha0": side,
        "viscous": speed,
        "delay": bump.slope(torque),
        "gravity_sin": mean(np.sin(q)),
        "gravity_cos": mean(np.cos(q)),
        "spring": mean(q),
        "asymmetry": np.full(len(side), scales.level),
        "viscous_difference": np.abs(speed),
        "drag": side * mean(part.speed**2),
        "drift": mean(part.time),
        **{
            key: mean(wave(key[1] * q))
            for group in wave_groups(scales)
            for key, wave in zip(group, (np.cos, np.sin), strict=True)
        },
    }


def fitted_balance(rows: Rows, keys: Sequence[Key], scales: Scales, values: Values) -> Fit:
    """Least squares of the torques, in which residuals have the unit of torque."""
    values = {**dict.fromkeys(keys, 0.0), **values}
    unknowns = Unknowns(scales.unknown(key, values) for key in keys)
    size, prior = unknowns.all("size"), (unknowns.all("size") / unknowns.all("spread")) ** 2
    columns = np.column_stack([rows.columns[key] for key in keys]) * size
    free, *_ = np.linalg.lstsq(columns, rows.torque, rcond=None)
    noise = float(np.std(rows.torque - columns @ free)) or 1e-300
    x, y = columns / noise, rows.torque / noise
    information = x.T @ x + np.diag(prior)
    step = np.linalg.solve(information, x.T @ y)
    left = y - x @ step
    starts = np.flatnonzero(np.diff(rows.block, prepend=-1.0))
    scores = np.add.reduceat(x * left[:, None], starts)
    blocks = np.add.reduceat(x[:, :, None] * x[:, None, :], starts)
    none = np.zeros((0, 0))
    linear = Linearised(
        information, 0.0 * step, blocks, scores, none, none, x, none, prior, prior, 0.0
    )
    cost = float(np.sum((noise * left) ** 2))
    there = unknowns.changed(values, size * step)
    return Fit(unknowns, State(there, none, noise * left[:, None], none, cost), linear)


def with_effects(rows: Rows, best: Fit, scales: Scales, more: Sequence[Group]) -> Fit:
    """The fit with all effects that the blocks support, ``more`` and waves."""
    groups = [*more, *wave_groups(scales)]
    while True:
        if len(waves_of(best)) >= MOST_WAVES:
            groups = [group for group in groups if group in more]
        found = []
        for group in groups:
            wider = fitted_balance(rows, (*best.unknowns.keys, *group), scales, best.values)
            if chance_of(wider, group) < (BY_CHANCE if group in more else WAVE_BY_CHANCE):
                found.append((wider.cost, group, wider))
        if not found:
            return best
        _, chosen, best = min(found, key=lambda each: each[0])
        groups.remove(chosen)


def covariance_with_missed(
    rows: Rows, best: Fit, scales: Scales, more: Sequence[Group]
) -> np.ndarray:
    """Covariance (p, p) in sizes, with how effects that were not found would change the values."""
    covered, keys = best.covariance, best.unknowns.keys
    for group in more:
        if group[0] not in keys:
            other = fitted_balance(rows, (*keys, *group), scales, best.values).values
            shift = best.unknowns.vector(other) - best.unknowns.vector(best.values)
            relative = shift / best.unknowns.all("size")
            covered = covered + np.outer(relative, relative)
    return covered
