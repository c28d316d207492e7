"""Fits an axis to the balance of its torques, where its motion cannot be predicted from them.

If most of the torque works against friction, as in a slow joint of a robot, small errors of the
torque move a simulated axis far. Its acceleration is then known better than what the torque causes,
and a fit of the motion makes the inertia too large. Here the equation of motion is multiplied by a
bump and integrated by parts, so that torque and acceleration are filtered alike.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np

from furuta.identification.averaging import (
    Averaged,
    Candidate,
    Catalogue,
    Group,
    Model,
    Neighbourhood,
    explained_by,
    most_probable,
)
from furuta.identification.axis.effects import (
    FALL,
    GRAVITY,
    STRIBECK,
    SURE,
    Scales,
    catalogue_of,
    wave_groups,
)
from furuta.identification.axis.segments import Smoothed, position_noise, smoothed
from furuta.identification.axis.start import SLIDES
from furuta.identification.errors import inverse
from furuta.identification.least_squares import Fit, Linearised, State
from furuta.identification.regression.windows import Windows, shortest
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
# Unknowns of a fit of the motion that are fitted only if the torques show them, and the delay [s]
# that is expected beforehand.
TESTED, DELAY = ("delay", "spring", *GRAVITY), 0.01
# How often the residuals of the last fit are taken for the noise.
REWEIGHTED = 2
# Usual intervals from which two samples have a gap between them.
GAP = 5.0


class Balance(NamedTuple):
    """A fit of torques, its errors, and what it leaves of the torque.

    ``start`` are the values with a fall of friction, if that explains more.
    """

    fit: Fit
    averaged: Averaged
    part: float
    start: Values

    @property
    def residual(self) -> Residual:
        """Of any size in the noise of the position, which the torques do not show."""
        return Residual("torque", np.inf, self.part)


class Rows(NamedTuple):
    """Columns of the balance by key (n,), torque (n,) and block of each row (n,).

    ``noise`` is the torque that a residual of one is.
    """

    columns: dict[Key, np.ndarray]
    torque: np.ndarray
    block: np.ndarray
    noise: float = 1.0


# The columns of a recording's balance, its torque among them, averaged over windows.
Columns = Callable[[Windows, Recording, Smoothed], dict[Key, np.ndarray]]


def balanced(recordings: Sequence[Recording], about: Fit, scales: Scales) -> Balance | None:
    """The fit with all effects that the torques support; None if too little of them slides."""
    keys = [key for key in about.keys if key not in TESTED]
    if min(map(_longest, recordings)) < SHORTEST:
        return None
    drifts = catalogue_of(drift=len(recordings) == 1, loaded=False)
    catalogue = drifts._replace(effects=[("delay",), *drifts.effects])

    def columns(windows: Windows, recording: Recording, part: Smoothed) -> dict[Key, np.ndarray]:
        found = torque_columns(windows, recording, part, wave_groups(), scales.level)
        for number, relative in enumerate(STRIBECK[1:]):
            fallen = np.exp(-((part.speed / (relative * scales.speed)) ** 2))
            found[FALL[0], number] = found["alpha0"] * windows.mean(fallen)
        return found

    length = max(window_length(recording) for recording in recordings)
    rows = sliding_rows(recordings, length, columns)
    if len(np.unique(rows.block)) < FEWEST_BLOCKS * len(keys):
        return None
    absent: list[Key] = [FALL[0], *TESTED]
    values = {**about.values, **dict.fromkeys(absent, 0.0)}
    rows, best = with_effects(rows, fitted_balance(rows, keys, scales, values), scales, catalogue)
    averaged = averaged_balance(rows, best, scales, catalogue)
    return Balance(best, averaged, left_over(rows, best), _with_fall(rows, best, scales))


def _with_fall(rows: Rows, best: Fit, scales: Scales) -> Values:
    """The values of the fit, with the fall of friction that explains most, if it is probable."""
    found = best
    for number, relative in enumerate(STRIBECK[1:]):
        columns = rows.columns | {FALL[0]: rows.columns[FALL[0], number]}
        values = {**best.values, FALL[1]: relative * scales.speed}
        other = fitted_balance(
            rows._replace(columns=columns), (*best.keys, FALL[0]), scales, values
        )
        found = other if other.values[FALL[0]] > 0.0 and other.cost < found.cost else found
    gained = explained_by(best.cost, found.cost, best.inflation(SURE))
    return found.values if gained > np.log(len(STRIBECK)) else best.values


def left_over(rows: Rows, best: Fit) -> float:
    """Residuals as a part of the torque."""
    return float(rows.noise * np.std(best.state.residuals) / (np.std(rows.torque) or 1e-300))


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
    """Least squares of the torques."""
    values = {**dict.fromkeys(keys, 0.0), **values}
    unknowns = _unknowns(keys, scales, values)
    start = unknowns.changed(values, np.zeros(len(unknowns)))
    about, _ = _linear(rows, unknowns, start)
    step = inverse(about.information, about.prior) @ about.gradient
    there = unknowns.changed(values, unknowns.all("size") * step)
    about, left = _linear(rows, unknowns, there)
    none, prior = np.zeros((0, 0)), step @ (about.prior * step)
    return Fit(unknowns, State(there, none, left[:, None], none, float(left @ left + prior)), about)


def _unknowns(keys: Iterable[Key], scales: Scales, values: Values) -> Unknowns:
    each = (scales.unknown(key, values) for key in keys)
    return Unknowns(u._replace(spread=DELAY) if u.key == "delay" else u for u in each)


def _linear(rows: Rows, unknowns: Unknowns, values: Values) -> tuple[Linearised, np.ndarray]:
    """The problem about values, and the residuals (n,)."""
    size, vector = unknowns.all("size"), unknowns.vector(values)
    columns = np.column_stack([rows.columns[key] for key in unknowns.keys])
    left = (rows.torque - columns @ vector) / rows.noise
    x, prior = columns * size / rows.noise, (size / unknowns.all("spread")) ** 2
    starts = np.flatnonzero(np.diff(rows.block, prepend=-1.0))
    scores = np.add.reduceat(x * left[:, None], starts)
    edges = itertools.pairwise([*starts, len(x)])
    blocks = np.array([x[a:b].T @ x[a:b] for a, b in edges])
    information = blocks.sum(axis=0) + np.diag(prior)
    gradient = scores.sum(axis=0) - prior * vector / size
    none = np.zeros((0, 0))
    about = Linearised(
        information, gradient, blocks, scores, none, none, x, none, prior, prior, 0.0
    )
    return about, left


def _about(rows: Rows, best: Fit, scales: Scales, catalogue: Catalogue) -> Neighbourhood:
    """All models about a fit."""
    keys = catalogue.keys(best.keys)
    values = {**best.values, **dict.fromkeys([key for key in keys if key not in best.keys], 0.0)}
    unknowns = _unknowns(keys, scales, values)
    return Neighbourhood.of(_linear(rows, unknowns, values)[0], unknowns, values, best, SURE)


def with_effects(rows: Rows, base: Fit, scales: Scales, catalogue: Catalogue) -> tuple[Rows, Fit]:
    """The fit with all effects that the blocks support, and rows with its residuals as noise."""

    def models(best: Fit) -> list[Candidate]:
        return _about(rows, best, scales, catalogue).candidates(catalogue)

    def refitted(best: Fit, model: Model) -> Fit:
        return fitted_balance(rows, model.keys(best.keys), scales, best.values)

    for _ in range(REWEIGHTED):
        rows = rows._replace(noise=rows.noise * base.rms or 1.0)
        base = fitted_balance(rows, base.keys, scales, base.values)
        base = most_probable(base, models, refitted, SURE)
    return rows, base


def averaged_balance(rows: Rows, best: Fit, scales: Scales, catalogue: Catalogue) -> Averaged:
    """Errors over all models that explain the torques about as well."""
    there = _about(rows, best, scales, catalogue)
    return there.averaged(there.candidates(catalogue))
