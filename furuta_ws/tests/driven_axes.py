"""Draws axes that move as engineers move them: under a position or speed controller, or by torque.

The motions are those of :mod:`true_axes`, with an integrator of its own. The controller runs at the
rate of the recording, reads the encoder, and its torque holds until the next sample.
"""

from math import pi
from typing import NamedTuple

import numpy as np
from true_axes import AT_ONCE, TrueAxis, advanced

from furuta_model.compiled import compiled
from furuta_recordings.recording import Recording

# Longest step [s] of the motion, and noise of the recorded torque relative to its largest value.
STEP, TORQUE_NOISE = 25e-6, 0.001
POINT_TO_POINT = ("s-curve", "s-curve with feedforward", "jog")
MOTIONS = (*POINT_TO_POINT, "triangle", "speed steps", "prbs", "sines")
RATES = (100.0, 250.0, 500.0, 1000.0)


class _Loop(NamedTuple):
    """Gains of a position controller, reference and feedforward (n,), and its largest torque.

    The slope of the error is filtered, with ``smooth`` [s].
    """

    kp: float
    ki: float
    kd: float
    smooth: float
    reference: np.ndarray
    forward: np.ndarray
    most: float


@compiled
def _move_under(
    a: TrueAxis, loop: _Loop, interval: float, count: float, position: np.ndarray, out: np.ndarray
) -> None:
    """Counted position and torque of each sample."""
    steps = int(np.ceil(interval / STEP))
    h, q, v, integral, before, slope = interval / steps, 0.0, 0.0, 0.0, 0.0, 0.0
    late = round(a.delay / h)
    for i in range(len(out)):
        position[i] = count * np.round(q / count)
        error = loop.reference[i] - position[i]
        slope += ((error - before) / interval - slope) * interval / (interval + loop.smooth)
        before = error
        wanted = loop.forward[i] + loop.kp * error + loop.ki * integral + loop.kd * slope
        out[i] = min(max(wanted, -loop.most), loop.most)
        if wanted == out[i]:
            integral += error * interval
        for step in range(steps):
            k = max(int(np.floor((i * steps + step - late) / steps)), -1)
            torque = out[k] if k >= 0 else 0.0
            q, v = advanced(a, q, v, torque, i * interval + step * h, h)


def _s_curve(share: np.ndarray) -> np.ndarray:
    """A move from 0 to 1 without a jump of the acceleration."""
    s = np.clip(share, 0.0, 1.0)
    return np.asarray(s**3 * (10.0 - 15.0 * s + 6.0 * s**2))


def _trapeze(share: np.ndarray) -> np.ndarray:
    """A move from 0 to 1 with a third of its time of constant speed."""
    s = np.clip(share, 0.0, 1.0)
    end = 1.0 - s
    return np.asarray(
        np.where(s < 1 / 3, 2.25 * s**2, np.where(s > 2 / 3, 1.0 - 2.25 * end**2, 1.5 * s - 0.25))
    )


def _moves(
    r: np.random.Generator, time: np.ndarray, kind: str, way: float, speed: float
) -> np.ndarray:
    """A path (n,) of moves between points at most ``way`` apart, with pauses between some."""
    path, at, begin = np.zeros(len(time)), 0.0, r.uniform(0.05, 0.3)
    to_and_fro = r.random() < 0.5
    while begin < time[-1]:
        target = (way if at == 0.0 else 0.0) if to_and_fro else way * r.uniform(0.0, 1.0)
        distance = target - at
        share = {"jog": _trapeze, "triangle": lambda s: np.clip(s, 0.0, 1.0)}.get(kind, _s_curve)
        mean = {"jog": 1.5, "triangle": 1.0}.get(kind, 1.875)
        length = max(mean * abs(distance) / speed, 0.05)
        path += distance * share((time - begin) / length)
        at, begin = target, begin + length
        if kind != "triangle":
            begin += r.uniform(0.1, 0.6)
    return path


def _levels(r: np.random.Generator, time: np.ndarray, shortest: float) -> np.ndarray:
    """Random levels within ±1 that are held for some time."""
    series, begin = np.zeros(len(time)), 0.1
    while begin < time[-1]:
        series[time >= begin] = r.choice((-1.0, 1.0)) * r.uniform(0.1, 1.0)
        begin += shortest * r.uniform(1.0, 3.0)
    return series


def driven_axis(seed: int) -> tuple[TrueAxis, str, Recording]:
    """A random axis, how it is moved, and a recording of it through an encoder."""
    r = np.random.default_rng(91_000 + seed)
    motion = MOTIONS[seed % len(MOTIONS)]
    rate, seconds = float(r.choice(RATES)), float(r.choice((10.0, 20.0, 30.0)))
    time = np.arange(int(seconds * rate)) / rate
    way, length = 10.0 ** r.uniform(-0.2, 1.1), r.uniform(0.3, 1.5)
    speed = way / length
    inertia = 10.0 ** r.uniform(-3.5, 1.3)
    push = inertia * 5.8 * way / length**2  # of an s-curve over the whole way
    level = push * 10.0 ** r.uniform(-0.7, 0.4)
    viscous = level / speed * 10.0 ** r.uniform(-1.3, 0.0)
    effects = _effects(r, level, viscous, speed, way, seconds)
    axis = TrueAxis(inertia, level, viscous, offset=level * r.uniform(-0.15, 0.15), **effects)
    count = 2.0 * pi / int(10.0 ** r.uniform(2.7, 4.3))
    usual = push + level + np.hypot(axis.gravity_sin, axis.gravity_cos)
    # As fast as delay, rate and the steps of the encoder allow.
    most = np.sqrt(0.2 * usual / (30.0 * inertia * count))
    slow = min(r.uniform(10.0, 40.0), 0.15 / (axis.delay + 1.5 / rate), most)
    kp, ki, kd = 3.0 * inertia * slow**2, inertia * slow**3, 3.0 * inertia * slow
    forward = np.zeros(len(time))
    if motion == "prbs":
        bits = np.sign(_levels(r, time, r.uniform(0.05, 0.3)))
        forward, reference = usual * r.uniform(1.0, 1.8) * bits, np.zeros(len(time))
        kp, ki, kd = 0.02 * kp, 0.0, 0.02 * kd  # holds the axis where it is, weakly
    elif motion == "sines":
        reference = sum(
            0.5 * way * part * np.sin(2.0 * pi * f * time + phase) * np.minimum(time, 1.0)
            for part, f, phase in zip(
                (0.6, 0.3, 0.1), r.uniform(0.2, 1.5, 3), r.uniform(0.0, 6.0, 3), strict=True
            )
        )
    elif motion == "speed steps":
        reference = np.cumsum(speed * _levels(r, time, r.uniform(0.3, 0.8))) / rate
        kp, ki = kd * slow, 0.0
    else:
        reference = _moves(r, time, motion.split()[0], way, speed)
    if motion.endswith("feedforward"):
        v = np.gradient(reference, time)
        known = r.uniform(0.7, 1.3, 3)
        forward = known[0] * inertia * np.gradient(v, time) + known[1] * viscous * v
        forward += known[2] * level * np.sign(v) * (np.abs(v) > 1e-3 * speed)
    position, torque = np.empty(len(time)), np.empty(len(time))
    loop = _Loop(kp, ki, kd, 0.1 / slow, reference, forward, 4.0 * usual)
    _move_under(axis, loop, 1.0 / rate, count, position, torque)
    measured = np.full((len(time), 4), np.nan)
    measured[:, 0] = position
    noise = TORQUE_NOISE * np.max(np.abs(torque)) * r.standard_normal(len(time))
    return axis, motion, Recording("axis", time, measured, time, torque + noise)


def _effects(
    r: np.random.Generator, level: float, viscous: float, speed: float, way: float, seconds: float
) -> dict[str, float]:
    """Each effect is there or not."""
    more: dict[str, float] = {}
    if r.random() < 0.5:
        more["delay"] = r.uniform(0.0, 0.008)
    if r.random() < 0.35:
        size, phase = level * r.uniform(0.2, 1.5), r.uniform(0.0, 2.0 * pi)
        more["gravity_sin"], more["gravity_cos"] = size * np.cos(phase), size * np.sin(phase)
    if r.random() < 0.2:
        more["spring"] = level / way * r.uniform(0.1, 0.8)
    kind = r.random()
    if kind < 0.2:
        more["alpha1"], more["stribeck_velocity"] = level * r.uniform(0.05, 0.6), AT_ONCE
    elif kind < 0.5:
        more["alpha1"] = level * r.uniform(0.1, 0.8)
        more["stribeck_velocity"] = speed * 10.0 ** r.uniform(-2.0, -0.4)
    if r.random() < 0.25:
        more["asymmetry"] = r.uniform(-0.3, 0.3)
    if r.random() < 0.2:
        more["viscous_difference"] = viscous * r.uniform(-0.4, 0.4)
    if r.random() < 0.15:
        more["drag"] = level / speed**2 * r.uniform(0.05, 0.4)
    if r.random() < 0.1:
        more["drift"] = level / seconds * r.uniform(0.05, 0.3)
    if r.random() < 0.35:
        more["order"], more["wave"] = float(r.integers(2, 30)), level * r.uniform(0.05, 0.5)
        more["phase"] = r.uniform(0.0, 2.0 * pi)
    return more
