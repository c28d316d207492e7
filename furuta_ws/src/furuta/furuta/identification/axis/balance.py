"""Fits an axis to the balance of its torques, where its motion cannot be predicted from them.

If most of the torque works against friction, as in a slow joint of a robot, small errors of the
torque move a simulated axis far. Its acceleration is then known better than what the torque causes,
and a fit of the motion makes the inertia too large. Here the equation of motion is multiplied by a
bump and integrated by parts, so that torque and acceleration are filtered alike.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np

from furuta.identification.axis.averaging import explained_by
from furuta.identification.axis.effects import (
    FALL,
    GRAVITY,
    MOST_WAVES,
    STRIBECK,
    WAVE_BY_CHANCE,
    Group,
    Scales,
    smooth_effects,
    wave_groups,
    waves_of,
)
from furuta.identification.axis.segments import Smoothed, position_noise, smoothed
from furuta.identification.axis.start import SLIDES
from furuta.identification.errors import inverse
from furuta.identification.least_squares import Fit, Linearised, State
from furuta.identification.regression.windows import Windows, shortest
from furuta.identification.selection import chance_of
from furuta.identification.unknowns import Key, Unknowns, Values
from furuta.identification.verdict import Residual
from furuta_model.state import PHI
from furuta_recordings.recording import Recording

# Shortest and longest window [s], and noise of the acceleration relative to it that is small: a
# regression makes the inertia too small by the square of it.
SHORTEST, LONGEST, SMALL = 0.2, 1.0, 0.05
# Fewest samples of a window.
FEWEST_SAMPLES = 12.0
# Part of a window's weight that need not slide in one direction: rounding.
ROUNDING = 1e-9
# Length [s] of a block of the jackknife, fewest blocks for each unknown, more than a recording has;
# windows begin by this part of their length apart.
BLOCK, FEWEST_BLOCKS, MANY, APART = 0.5, 2.0, 10**9, 0.25
# Largest probability by chance of an effect: errors of the torque that repeat with the motion look
# like one.
BY_CHANCE = 1e-3
# Unknowns of a fit of the motion that are fitted only if the torques show them.
TESTED = ("delay", "spring", *GRAVITY)
# Part of a column that others do not explain, below which it is left out.
INDEPENDENT = 0.02
# Usual intervals from which two samples have a gap between them.
GAP = 5.0


class Balance(NamedTuple):
    """A fit of torques, its covariance (p, p) in sizes, and what it leaves of the torque.

    ``start`` are the values with a fall of friction, if that explains more.
    """

    fit: Fit
    covariance: np.ndarray
    part: float
    start: Values

    @property
    def residual(self) -> Residual:
        """Of any size in the noise of the position, which the torques do not show."""
        return Residual("torque", np.inf, self.part)


class Rows(NamedTuple):
    """Columns of the balance by key (n,), torque (n,) and block of each row (n,)."""

    columns: dict[Key, np.ndarray]
    torque: np.ndarray
    block: np.ndarray


# The columns of a recording's balance, its torque among them, averaged over windows.
Columns = Callable[[Windows, Recording, Smoothed], dict[Key, np.ndarray]]


def balanced(recordings: Sequence[Recording], about: Fit, scales: Scales) -> Balance | None:
    """The fit with all effects that the torques support; None if too little of them slides.

    It has no delay, which a slow motion does not show.
    """
    keys = [key for key in about.unknowns.keys if key not in TESTED]
    if min(map(_longest, recordings)) < SHORTEST:
        return None

    def columns(windows: Windows, recording: Recording, part: Smoothed) -> dict[Key, np.ndarray]:
        found = torque_columns(windows, recording, part, wave_groups(scales), scales.level)
        for number, relative in enumerate(STRIBECK[1:]):
            fallen = np.exp(-((part.speed / (relative * scales.speed)) ** 2))
            found[FALL[0], number] = found["alpha0"] * windows.mean(fallen)
        return found

    length = max(window_length(recording) for recording in recordings)
    rows = sliding_rows(recordings, length, columns)
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
    return Balance(best, covered, left_over(rows, best), _with_fall(rows, best, scales))


def _with_fall(rows: Rows, best: Fit, scales: Scales) -> Values:
    """The values of the fit, with the fall of friction that explains most, if it is probable."""
    found = best
    for number, relative in enumerate(STRIBECK[1:]):
        columns = rows.columns | {FALL[0]: rows.columns[FALL[0], number]}
        values = {**best.values, FALL[1]: relative * scales.speed}
        keys = (*best.unknowns.keys, FALL[0])
        other = fitted_balance(rows._replace(columns=columns), keys, scales, values)
        found = other if other.values[FALL[0]] > 0.0 and other.cost < found.cost else found
    gained = explained_by(best.cost, found.cost, len(rows.torque) / best.segments * best.rms**2)
    return found.values if gained > np.log(len(STRIBECK)) else best.values


def left_over(rows: Rows, best: Fit) -> float:
    """Residuals as a part of the torque."""
    return float(np.std(best.state.residuals) / (np.std(rows.torque) or 1e-300))


def window_length(recording: Recording, least: float = SHORTEST, small: float = SMALL) -> float:
    """The shortest length [s] at which the noise of the position hardly changes the inertia."""
    part = smoothed(recording)
    step = part.time[1] - part.time[0]
    length, longest = max(least, FEWEST_SAMPLES * step), min(LONGEST, _longest(recording))
    position = np.interp(part.time, recording.time, recording.measured[:, PHI])
    while length < longest:
        windows = Windows(part.time, length)
        size = np.std(windows.curvature(position))
        if position_noise(recording) * windows.noise(2) < small * size:
            break
        length *= 1.5
    return min(length, longest)


def _longest(recording: Recording) -> float:
    """The longest bump [s] of which a recording holds enough."""
    return recording.duration / shortest(1.0)


def sliding_rows(recordings: Sequence[Recording], length: float, columns: Columns) -> Rows:
    """One row for each window of a length [s] over which an axis slides in one direction."""
    parts = [smoothed(recording) for recording in recordings]
    slow = SLIDES * max(float(np.max(np.abs(part.speed))) for part in parts)
    gathered, blocks = [], []
    for number, (recording, part) in enumerate(zip(recordings, parts, strict=True)):
        windows = Windows(part.time, length, APART)
        found = columns(windows, recording, part)
        for other in range(len(parts)):
            found["offset", other] = np.full(len(found["torque"]), float(other == number))
        slides = np.where(np.abs(part.speed) > slow, np.sign(part.speed), 0.0)
        slides *= has_samples(recording, part.time)
        whole = np.abs(windows.mean(slides)) > 1.0 - ROUNDING
        gathered.append({name: column[whole] for name, column in found.items()})
        blocks.append(MANY * number + (windows.starts[whole] - part.time[0]) // BLOCK)
    joined = {name: np.concatenate([each[name] for each in gathered]) for name in gathered[0]}
    return Rows(joined, joined.pop("torque"), np.concatenate(blocks))


def has_samples(recording: Recording, time: np.ndarray) -> np.ndarray:
    """Where times lie in no gap."""
    after = np.clip(np.searchsorted(recording.time, time), 1, len(recording.time) - 1)
    has: np.ndarray = np.diff(recording.time)[after - 1] < GAP * recording.interval
    return has


def torque_columns(
    windows: Windows, recording: Recording, part: Smoothed, waves: Iterable[Group], level: float
) -> dict[Key, np.ndarray]:
    """The torque, and what each unknown of an axis contributes to it, averaged over windows.

    An asymmetry acts in proportion to a ``level`` of friction.
    """
    mean = windows.mean
    # A command holds until the next one: its mean about a time is that of the one before and after.
    half = 0.5 * (part.time[1] - part.time[0])
    before, after = (recording.commanded_at(part.time + each) for each in (-half, half))
    torque = 0.5 * (before + after)
    q = np.interp(part.time, recording.time, recording.measured[:, PHI])
    speed, side = windows.slope(q), np.sign(mean(part.speed))
    return {
        "torque": mean(torque),
        "inertia": windows.curvature(q),
        "alpha0": side,
        "viscous": speed,
        "delay": windows.slope(torque),
        "gravity_sin": mean(np.sin(q)),
        "gravity_cos": mean(np.cos(q)),
        "spring": mean(q),
        "asymmetry": np.full(len(side), level),
        "viscous_difference": np.abs(speed),
        "drag": side * mean(part.speed**2),
        "drift": mean(part.time),
        **{
            key: mean(wave(key[1] * q))
            for group in waves
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
    step = inverse(information) @ (x.T @ y)
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
            if not independent(rows, best.unknowns.keys, group):
                continue
            wider = fitted_balance(rows, (*best.unknowns.keys, *group), scales, best.values)
            if chance_of(wider, group) < (BY_CHANCE if group in more else WAVE_BY_CHANCE):
                found.append((wider.cost, group, wider))
        if not found:
            return best
        _, chosen, best = min(found, key=lambda each: each[0])
        groups.remove(chosen)


def independent(rows: Rows, known: Sequence[Key], more: Sequence[Key]) -> bool:
    """Whether further columns act differently from those that are fitted."""
    basis, _ = np.linalg.qr(np.column_stack([rows.columns[key] for key in known]))
    for key in more:
        column = rows.columns[key]
        left = column - basis @ (basis.T @ column)
        if np.linalg.norm(left) < INDEPENDENT * np.linalg.norm(column):
            return False
    return True


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
