"""Moves axes with dry friction in small steps, by equations of its own, and draws random ones.

In each step friction takes from the speed what it can, down to 0; a breakaway level must be
exceeded from there.
"""

from math import pi
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled, inlined
from furuta_recordings.recording import Recording

# Steps per sample, and noise of the recorded torque relative to its largest acceleration.
PER_SAMPLE, TORQUE_NOISE = 100, 0.002
SECONDS, RATE = 20.0, 1000.0
# Velocity [rad/s] of a fall of friction that is over at once.
AT_ONCE = 1e-9


class TrueAxis(NamedTuple):
    """Parameters by the names of the fit; of one wave the order, size and phase; faults.

    ``load_friction`` is friction per size of the torque, ``drag`` with v².
    """

    inertia: float
    alpha0: float
    viscous: float
    offset: float = 0.0
    delay: float = 0.0
    gravity_sin: float = 0.0
    gravity_cos: float = 0.0
    spring: float = 0.0
    alpha1: float = 0.0
    stribeck_velocity: float = 1.0
    asymmetry: float = 0.0
    viscous_difference: float = 0.0
    order: float = 1.0
    wave: float = 0.0
    phase: float = 0.0
    load_friction: float = 0.0
    drag: float = 0.0
    drift: float = 0.0

    def values(self) -> dict[str, float]:
        """What a fit reports of it; what is not there is 0."""
        wave = {}
        if self.wave:
            wave[f"cos {self.order:.0f}"] = self.wave * np.cos(self.phase)
            wave[f"sin {self.order:.0f}"] = -self.wave * np.sin(self.phase)
        values = self._asdict()
        values["stribeck_velocity"] *= self.alpha1 != 0.0
        return {**values, **wave}


@inlined
def advanced(
    a: TrueAxis, q: float, v: float, torque: float, time: float, h: float
) -> tuple[float, float]:
    """Position and speed after a short step of h [s] from a time [s]."""
    net = torque - a.offset - a.spring * q - a.wave * np.cos(a.order * q + a.phase)
    net -= a.gravity_sin * np.sin(q) + a.gravity_cos * np.cos(q) + a.drift * time
    side = np.sign(v) if v != 0.0 else np.sign(net)
    level = a.alpha0 + a.alpha1 * np.exp(-((v / a.stribeck_velocity) ** 2))
    level += a.load_friction * abs(torque) + a.drag * v * v
    free = v + h / a.inertia * (net - a.viscous * v - a.viscous_difference * abs(v))
    left = max(abs(free) - h / a.inertia * (1.0 + side * a.asymmetry) * level, 0.0)
    after = 0.0 if v * free < 0.0 else np.sign(free) * left
    return q + 0.5 * h * (v + after), after


@compiled
def _move(a: TrueAxis, torque: np.ndarray, interval: float, out: np.ndarray) -> None:
    """Position at each sample; the torque of sample k holds until the next one."""
    h, q, v = interval / PER_SAMPLE, 0.0, 0.0
    late = a.delay / h
    for i in range(len(torque)):
        out[i] = q
        for step in range(PER_SAMPLE):
            k = int(np.floor((i * PER_SAMPLE + step - late) / PER_SAMPLE + 1e-9))
            q, v = advanced(a, q, v, torque[max(k, 0)], i * interval + step * h, h)


def positions(axis: TrueAxis, torque: np.ndarray, interval: float) -> np.ndarray:
    """Positions (n,) [rad] under a torque (n,) [N m] that is held for each interval [s]."""
    out = np.empty(len(torque))
    _move(axis, torque, interval, out)
    return out


def recorded(
    axis: TrueAxis, torque: np.ndarray, interval: float, count: float, noise: np.ndarray | float = 0
) -> Recording:
    """A recording in counts of an encoder [rad], with noise of the recorded torque [N m]."""
    time = interval * np.arange(len(torque))
    measured = np.full((len(torque), 4), np.nan)
    measured[:, 0] = count * np.round(positions(axis, torque, interval) / count)
    return Recording("axis", time, measured, time, torque + noise)


def multisine(time: np.ndarray, lowest: float) -> np.ndarray:
    """A torque of three sines, 0 at first; its largest value is below 0.27."""
    parts = ((0.13, lowest, 0.0), (0.09, 1.9, 1.0), (0.05, 4.3, 2.0))
    torque = sum(size * np.sin(2.0 * pi * f * time + phase) for size, f, phase in parts)
    return np.asarray(torque * (time >= 0.1))


def random_axis(seed: int) -> tuple[TrueAxis, float, Recording]:
    """A random axis, its usual torque [N m], and a recording of it through an encoder."""
    r = np.random.default_rng(7000 + seed)
    inertia = 10.0 ** r.uniform(-3.5, 1.0)
    usual = inertia * r.uniform(20.0, 80.0)
    level = usual * 0.27 / r.uniform(1.5, 6.0)
    viscous = inertia * r.uniform(0.2, 4.0)
    more = {"offset": level * r.uniform(-0.1, 0.1), **_random_effects(r, usual, level, viscous)}
    counts = int(10.0 ** r.uniform(2.7, 4.3))
    time = np.arange(int(SECONDS * RATE)) / RATE
    torque = usual / 0.3 * multisine(time, r.uniform(0.4, 0.8))
    if r.random() < 0.5:
        torque *= np.clip(0.3 + 0.7 * np.abs(np.sin(3.0 * pi * time / SECONDS)), 0.0, 1.0)
    axis = TrueAxis(inertia, level, viscous, **more)
    noise = TORQUE_NOISE * usual * r.standard_normal(len(time))
    return axis, usual, recorded(axis, torque, 1.0 / RATE, 2.0 * pi / counts, noise)


def _random_effects(
    r: np.random.Generator, usual: float, level: float, viscous: float
) -> dict[str, float]:
    """Each effect is there or not."""
    more: dict[str, float] = {}
    if r.random() < 0.5:
        more["delay"] = r.uniform(0.0, 0.01)
    if r.random() < 0.35:
        more["gravity_sin"], more["gravity_cos"] = 0.2 * usual * r.uniform(-1.0, 1.0, 2)
    if r.random() < 0.3:
        more["spring"] = 0.1 * usual * r.uniform(0.2, 1.0)
    kind = r.random()
    if kind < 0.25:
        more["alpha1"], more["stribeck_velocity"] = level * r.uniform(0.05, 0.6), AT_ONCE
    elif kind < 0.6:
        more["alpha1"] = level * r.uniform(0.1, 0.8)
        more["stribeck_velocity"] = 10.0 ** r.uniform(-1.7, -0.2)
    if r.random() < 0.3:
        more["asymmetry"] = r.uniform(-0.3, 0.3)
    if r.random() < 0.2:
        more["viscous_difference"] = viscous * r.uniform(-0.4, 0.4)
    if r.random() < 0.3:
        more["order"], more["wave"] = float(r.integers(2, 25)), level * r.uniform(0.05, 0.5)
        more["phase"] = r.uniform(0.0, 2.0 * pi)
    return more
