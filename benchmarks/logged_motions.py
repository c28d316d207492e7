"""Draws axes, servos and rigs, and the logs that people keep of them.

An axis is moved in twelve ways, by a controller or by its torque, over 0.2 to 60 rad, and read by
encoders of 500 to 1000000 counts. The log holds the torque that was commanded, or the one that was
measured at the instant of the row, which has acted before.
"""

from math import exp, pi
from typing import NamedTuple

import numpy as np
from sticking_motion import Axis, moved

TORQUES, RATES = ("chirp", "random binary"), (100.0, 125.0, 200.0, 250.0, 500.0, 1000.0)
PATHS = ("s-curve", "cascade", "jog", "pick and place", "steps", "speed steps")
KINDS = (*TORQUES, *PATHS, "triangle", "stairs", "slow and fast", "sines")
WAVES = range(1, 49)
# Fewest counts over which an axis moves, and travel [rad] from which gravity is no spring.
COUNTS, SHORT = 60.0, 0.7


class Logged(NamedTuple):
    """A log: how it was moved, what is true of it, true values by name, and its columns (n,).

    Positions are in rad, torques in N m. Values that are not named are 0.
    """

    kind: str
    traits: tuple[str, ...]
    values: dict[str, float]
    time: np.ndarray
    position: np.ndarray
    command: np.ndarray


class _Controller(NamedTuple):
    """Gains of position, its integral and speed; of a cascade those of speed and its integral."""

    kp: float
    ki: float
    kd: float
    smooth: float
    cascade: bool
    most: float


def log_uniform(r: np.random.Generator, low: float, high: float) -> float:
    """A number of which every decade is as probable."""
    return float(np.exp(r.uniform(np.log(low), np.log(high))))


def logged_axis(seed: int, loaded: bool = False) -> Logged:
    """A random axis and a log of it; a ``loaded`` one has friction under load and no waves."""
    r = np.random.default_rng((17, seed, loaded))
    kind = KINDS[seed % len(KINDS)]
    rate, seconds = float(r.choice(RATES)), float(r.uniform(10.0, 18.0))
    time = np.arange(int(seconds * rate)) / rate
    way = log_uniform(r, 0.2, 60.0)
    length = r.uniform(0.3, 1.5) * max(way / 6.0, 1.0) ** 0.5
    speed, inertia = way / length, log_uniform(r, 3e-4, 20.0)
    push = 5.8 * inertia * way / length**2
    level = push * log_uniform(r, 0.2, 2.5)
    axis, delay = _axis(r, inertia, level, way, speed, seconds, loaded)
    usual = push + (1.0 + axis.load_friction) * level + np.hypot(axis.gravity_sin, axis.gravity_cos)
    count = 2.0 * pi / int(max(log_uniform(r, 500.0, 1e6), COUNTS * 2.0 * pi / way))
    noise = count * r.uniform(0.5, 3.0) if r.random() < 0.15 else 0.0
    # As fast as delay, rate and the steps of the encoder allow.
    most = np.sqrt(0.2 * usual / (30.0 * inertia * np.hypot(count, 4.0 * noise)))
    fast = min(r.uniform(10.0, 40.0), 0.15 / (delay + axis.lag + 1.5 / rate), most)
    one_way = kind in ("jog", "stairs", "speed steps") and r.random() < 0.15
    loop, reference, forward = _moves(r, kind, time, way, speed, fast, axis, usual, one_way)
    measured = bool(r.random() < 0.3)
    errors = noise * r.standard_normal(len(time))
    position, torque = _run(
        axis, loop, 1.0 / rate, delay, reference, forward, count, errors, measured
    )
    sizes = r.choice([0.0, 0.002, 0.01]) * np.sqrt(np.mean(torque**2))
    torque = torque + sizes * r.standard_normal(len(time))
    late = (
        _measured_late(delay % (1.0 / rate), axis.lag, 1.0 / rate) if measured else delay + axis.lag
    )
    traits = [
        "torque measured" if measured else "torque commanded",
        *(["friction under load"] if axis.load_friction else []),
        *(["lag"] if axis.lag else []),
        *(["waves"] if len(axis.waves) else []),
        *(["falls at once"] if axis.alpha1 and not axis.stribeck_velocity else []),
        *(["Stribeck"] if axis.stribeck_velocity else []),
        *(["one way"] if one_way else []),
        *(["short travel"] if np.ptp(position) < SHORT else []),
        *(["white noise"] if noise else []),
        *(["coarse"] if np.ptp(position) < 1000.0 * count else []),
    ]
    return Logged(kind, tuple(traits), _values(axis, late), time, position, torque)


def _measured_late(rest: float, lag: float, interval: float) -> float:
    """By how much [s] a torque acts after it is logged that was measured at the end of a row.

    ``rest`` is the part of the delay within a row. It is the mean over the past of what acts, less
    the same of what is logged.
    """
    if lag == 0.0:
        return rest - interval
    earlier = exp((rest - interval) / lag) / (1.0 - exp(-interval / lag))
    return rest + lag - interval * (1.0 + earlier)


def _values(axis: Axis, delay: float) -> dict[str, float]:
    """By the names of a report; offsets are those at the middle of a log."""
    left_out = ("lag", "stiffness", "limit", "waves")
    values = {name: value for name, value in axis._asdict().items() if name not in left_out}
    for order, cosine, sine in axis.waves:
        if order == 1.0:  # that is gravity
            values["gravity_cos"] = values.get("gravity_cos", 0.0) + cosine
            values["gravity_sin"] = values.get("gravity_sin", 0.0) + sine
            continue
        values |= {f"cos {order:.0f}": cosine, f"sin {order:.0f}": sine}
    return {name: float(value) for name, value in values.items() if value} | {"delay": delay}


def _axis(
    r: np.random.Generator,
    inertia: float,
    level: float,
    way: float,
    speed: float,
    seconds: float,
    loaded: bool,
) -> tuple[Axis, float]:
    """A random axis, of which each effect is there or not, and its delay [s]."""
    more: dict[str, float] = {"offset": level * r.uniform(-0.15, 0.15)}
    viscous = level / speed * log_uniform(r, 0.05, 1.0)
    if r.random() < 0.35:
        size, phase = level * r.uniform(0.2, 1.8), r.uniform(0.0, 2.0 * pi)
        more |= {"gravity_sin": size * np.cos(phase), "gravity_cos": size * np.sin(phase)}
    if r.random() < 0.12:
        more["spring"] = level / way * r.uniform(0.1, 0.8)
    fall = r.random()
    if fall < 0.5:
        more["alpha1"] = level * r.uniform(0.1, 0.8)
        more["stribeck_velocity"] = speed * log_uniform(r, 0.01, 0.4) if fall < 0.3 else 0.0
    for name, probable, size in (
        ("asymmetry", 0.25, 0.3),
        ("viscous_difference", 0.2, 0.4 * viscous),
        ("drift", 0.1, 0.3 * level / seconds),
    ):
        if r.random() < probable:
            more[name] = size * r.uniform(-1.0, 1.0)
    if r.random() < 0.15:
        more["drag"] = level / speed**2 * r.uniform(0.05, 0.4)
    if loaded or r.random() < 0.2:
        more["load_friction"] = r.uniform(0.02, 0.15)
    if r.random() < 0.4:
        more["lag"] = log_uniform(r, 2e-4, 3e-3)
    delay = float(r.uniform(0.0, 0.008)) if r.random() < 0.4 else 0.0
    count = 0 if loaded or r.random() > 0.35 else int(r.integers(1, 3))
    orders = r.choice(WAVES, count, replace=False)
    sizes, phases = level * r.uniform(0.05, 0.4, count), r.uniform(0.0, 2.0 * pi, count)
    waves = np.column_stack([orders, sizes * np.cos(phases), sizes * np.sin(phases)])
    return Axis(inertia, level, viscous, waves=waves.astype(float), **more), delay


def _moves(
    r: np.random.Generator,
    kind: str,
    time: np.ndarray,
    way: float,
    speed: float,
    fast: float,
    axis: Axis,
    usual: float,
    one_way: bool,
) -> tuple[_Controller, np.ndarray, np.ndarray]:
    """A controller, and reference and torque beside it (n,)."""
    j, none = axis.inertia, np.zeros(len(time))
    gains = (3.0 * j * fast**2, j * fast**3, 3.0 * j * fast)
    loop = _Controller(*gains, 0.1 / fast, False, 4.0 * usual)
    if kind in TORQUES:
        held = loop._replace(kp=0.02 * gains[0], ki=0.0, kd=0.02 * gains[2])
        if kind == "chirp":
            low, high = r.uniform(0.3, 0.8), r.uniform(2.0, 8.0)
            phase = 2.0 * pi * (low + 0.5 * (high - low) * time / time[-1]) * time
            return held, none, 1.6 * usual * np.sin(phase)
        return (
            held,
            none,
            r.uniform(1.0, 1.8) * usual * np.sign(_levels(r, time, r.uniform(0.05, 0.3))),
        )
    if kind == "sines":
        parts = zip((0.6, 0.3, 0.1), r.uniform(0.2, 1.5, 3), r.uniform(0.0, 6.0, 3), strict=True)
        sines = sum(size * np.sin(2.0 * pi * f * time + phase) for size, f, phase in parts)
        return loop, 0.5 * way * sines * np.minimum(time, 1.0), none
    if kind == "speed steps":
        steps = _levels(r, time, r.uniform(0.3, 0.8))
        path = np.cumsum(speed * (np.abs(steps) if one_way else steps)) * (time[1] - time[0])
        return loop._replace(ki=0.0), path, none
    path = _path(r, kind, time, way, speed, one_way)
    loop = loop._replace(cascade=kind == "cascade")
    if kind in ("s-curve", "cascade", "pick and place") and r.random() < 0.5:
        v, known = np.gradient(path, time), r.uniform(0.7, 1.3, 3)
        slides = np.sign(v) * (np.abs(v) > 1e-3 * speed)
        forward = known[0] * j * np.gradient(v, time) + known[1] * axis.viscous * v
        return loop, path, forward + known[2] * axis.alpha0 * slides
    return loop, path, none


def _levels(r: np.random.Generator, time: np.ndarray, shortest: float) -> np.ndarray:
    """Random levels within ±1 that are held for some time."""
    series, begin = np.zeros(len(time)), 0.1
    while begin < time[-1]:
        series[time >= begin] = r.choice((-1.0, 1.0)) * r.uniform(0.1, 1.0)
        begin += shortest * r.uniform(1.0, 3.0)
    return series


def _path(
    r: np.random.Generator, kind: str, time: np.ndarray, way: float, speed: float, one_way: bool
) -> np.ndarray:
    """A path (n,) of moves, with pauses between most of them."""
    path, at, begin = np.zeros(len(time)), 0.0, r.uniform(0.05, 0.3)
    places, k = way * r.uniform(0.0, 1.0, 4), 0
    while begin < time[-1]:
        k += 1
        steps = (at + way * (0.3 if kind == "stairs" else 1.0)) if one_way else None
        target = {
            "triangle": way * (k % 2),
            "stairs": way * abs((k / 5.0 + 1.0) % 2.0 - 1.0),
            "pick and place": places[k % 4],
        }.get(kind, way * r.uniform(0.0, 1.0))
        target = target if steps is None else steps
        slower = r.choice((0.1, 1.0)) if kind == "slow and fast" else 1.0
        shape = kind if kind in ("jog", "triangle", "stairs", "steps") else "s-curve"
        mean = {"jog": 1.5, "triangle": 1.0, "stairs": 1.0, "steps": 0.0}.get(shape, 1.875)
        lasts = max(mean * abs(target - at) / (speed * slower), 1e-9 if shape == "steps" else 0.05)
        s = np.clip((time - begin) / lasts, 0.0, 1.0)
        if shape == "s-curve":
            s = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        elif shape == "jog":
            thirds = np.where(s < 2 / 3, 1.5 * s - 0.25, 1.0 - 2.25 * (1.0 - s) ** 2)
            s = np.where(s < 1 / 3, 2.25 * s**2, thirds)
        path += (target - at) * s
        at, begin = target, begin + lasts
        begin += 0.0 if kind == "triangle" else r.uniform(0.1, 0.6)
    return path


def _run(
    axis: Axis,
    loop: _Controller,
    interval: float,
    delay: float,
    reference: np.ndarray,
    forward: np.ndarray,
    count: float,
    errors: np.ndarray,
    measured: bool,
) -> tuple[np.ndarray, np.ndarray]:
    """Positions and torques (n,) that are logged."""
    position, torque, sent = (np.zeros(len(errors)) for _ in range(3))
    state, integral, before, slope = (0.0, 0.0, 0.0), 0.0, 0.0, 0.0
    whole, rest = divmod(delay, interval)
    for i in range(len(errors)):
        position[i] = count * np.round((state[0] + errors[i]) / count)
        torque[i] = state[2]
        error = reference[i] - position[i]
        slope += ((error - before) / interval - slope) * interval / (interval + loop.smooth)
        before = error
        wanted = forward[i] + loop.kp * error + loop.kd * slope + loop.ki * integral
        if loop.cascade:
            off = loop.kp / loop.kd * error + slope
            wanted = forward[i] + loop.kd * off + loop.ki / loop.kp * loop.kd * integral
        sent[i] = min(max(wanted, -loop.most), loop.most)
        if wanted == sent[i]:
            integral += (off if loop.cascade else error) * interval
        late, time = i - int(whole), (i - 0.5 * len(errors)) * interval
        earlier, now = (sent[k] if k >= 0 else 0.0 for k in (late - 1, late))
        if rest:
            state = moved(axis, state, earlier, time, rest)
        state = moved(axis, state, now, time + rest, interval - rest)
    return position, torque if measured else sent


def logged_servo(seed: int, sticks: bool) -> Logged:
    """A random servo with a loop of its own, with or without stiction; the command is its goal."""
    r = np.random.default_rng((19, seed, sticks))
    kind = ("triangle", "steps", "sines", "s-curve", "jog")[seed % 5]
    rate, seconds = float(r.choice((50.0, 100.0, 200.0))), float(r.uniform(12.0, 30.0))
    time = np.arange(int(seconds * rate)) / rate
    way, length = r.uniform(0.3, 2.5), r.uniform(0.4, 1.5)
    frequency = r.uniform(10.0, 30.0)
    friction = log_uniform(r, 0.003, 0.04)
    limit = r.uniform(0.1, 0.6) if r.random() < 0.4 else 1e3
    axis = Axis(
        frequency**-2.0,
        friction,
        2.0 * r.uniform(0.6, 1.4) / frequency,
        offset=friction * r.uniform(-0.5, 0.5),
        alpha1=friction * r.uniform(0.2, 0.8) if sticks else 0.0,
        stiffness=1.0,
        limit=limit,
    )
    delay = float(r.uniform(0.0, 0.02))
    if kind == "sines":
        goal = _moves(r, kind, time, way, 1.0, 1.0, axis, 1.0, False)[1]
    else:
        goal = _path(r, kind, time, way, way / length, False)
    count = 2.0 * pi / float(r.choice((1024.0, 4096.0, 16384.0)))
    position, state, whole = np.zeros(len(time)), (0.0, 0.0, 0.0), divmod(delay, 1.0 / rate)
    for i in range(len(time)):
        position[i] = count * np.round(state[0] / count)
        late = i - int(whole[0])
        earlier, now = (goal[k] if k >= 0 else goal[0] for k in (late - 1, late))
        state = moved(axis, state, earlier, time[i], whole[1])
        state = moved(axis, state, now, time[i] + whole[1], 1.0 / rate - whole[1])
    values = {**_values(axis, delay), "friction": friction}
    reached = np.max(np.abs(goal - position)) > limit
    values |= {"limit": limit} if reached else {}
    return Logged(kind, ("sticks" if sticks else "slides",), values, time, position, goal)
