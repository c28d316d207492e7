"""The motion of an axis along recordings, and its tangents: how it changes with the parameters.

A breakaway falls on a command, so a small change of a level does not shift it: tangents do not
know its stairs. A stop has speed 0, so the shift of its time changes no position; but if the axis
turns back at once, it begins to do so earlier or later.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp

import numpy as np

from furuta.identification.axis.motion import (
    MOST_EVENTS,
    SHORTEST,
    SMALL,
    AxisData,
    AxisModel,
    Slide,
    integrals,
    level,
    next_slide,
)
from furuta.identification.bodies.body import Segments
from furuta.identification.unknowns import Key
from furuta_model.compiled import compiled, inlined

# What a tangent belongs to, if not to a field of the model.
POSITION, SPEED, OFFSET, COSINE, SINE = -2, -1, -3, -4, -5


_J, _A0, _B, _DELAY, _GS, _GC, _K, _A1, _VS, _ASYM, _D, _DRAG, _DRIFT, _LOAD = (
    AxisModel._fields.index(name)
    for name in (
        "inertia",
        "alpha0",
        "viscous",
        "delay",
        "gravity_sin",
        "gravity_cos",
        "spring",
        "alpha1",
        "stribeck_velocity",
        "asymmetry",
        "viscous_difference",
        "drag",
        "drift",
        "load_friction",
    )
)


@inlined
def _slopes_of_integrals(
    damping: float, h: float, first: float, second: float
) -> tuple[float, float]:
    """How these integrals change with the damping."""
    x = damping * h
    if abs(x) < SMALL:
        return h * h * (x / 3.0 - 0.5), h * h * h * (x / 12.0 - 1.0 / 6.0)
    of_first = (h * exp(-x) - first) / damping
    return of_first, -(of_first + second) / damping


@inlined
def _load_slope(q: float, m: AxisModel) -> float:
    """Slope of the load in the position."""
    slope = m.spring + m.gravity_sin * np.cos(q) - m.gravity_cos * np.sin(q)
    for k in range(m.waves.shape[0]):
        n = m.waves[k, 0]
        slope += n * (m.waves[k, 2] * np.cos(n * q) - m.waves[k, 1] * np.sin(n * q))
    return slope


@inlined
def _direct(  # noqa: PLR0911, PLR0912 - a case for each unknown
    kind: int, number: int, of: int, time: float, slide: Slide, m: AxisModel
) -> float:
    """Change of the torque with an unknown itself."""
    q, v = slide.position, slide.speed
    side = slide.sign * (1.0 + slide.sign * m.asymmetry)
    ratio = v / m.stribeck_velocity
    if kind == _J:
        return -slide.pull
    if kind == _A0:
        return -side
    if kind == _GS:
        return float(-np.sin(q))
    if kind == _GC:
        return float(-np.cos(q))
    if kind == _K:
        return -q
    if kind == _A1:
        return -side * exp(-ratio * ratio)
    if kind == _VS:
        return -side * m.alpha1 * exp(-ratio * ratio) * 2.0 * ratio * ratio / m.stribeck_velocity
    if kind == _ASYM:
        return -level(v, slide.torque, m)
    if kind == _DRAG:
        return -side * v * v
    if kind == _LOAD:
        return -side * abs(slide.torque)
    if kind == _DRIFT:
        return -time
    if kind == OFFSET:
        return -1.0 if number == of else 0.0
    if kind == COSINE:
        return float(-np.cos(number * q))
    if kind == SINE:
        return float(-np.sin(number * q))
    return 0.0


@inlined
def _of_damping(kind: int, slide: Slide, m: AxisModel) -> float:
    """Change of the damping with an unknown."""
    if kind == _J:
        return -slide.damping / m.inertia
    if kind == _B:
        return 1.0 / m.inertia
    return slide.sign / m.inertia if kind == _D else 0.0


@inlined
def _fall(slide: Slide, m: AxisModel) -> float:
    """Slope of the pull in the speed, as far as the level depends on it."""
    side = slide.sign * (1.0 + slide.sign * m.asymmetry)
    slope = -2.0 * m.drag * slide.speed
    if m.alpha1 != 0.0:
        ratio = slide.speed / m.stribeck_velocity
        slope += m.alpha1 * exp(-ratio * ratio) * 2.0 * ratio / m.stribeck_velocity
    return side * slope / m.inertia


@inlined
def _carry(
    dq: np.ndarray,
    dv: np.ndarray,
    v: float,
    slide: Slide,
    left: float,
    time: float,
    of: int,
    kinds: np.ndarray,
    numbers: np.ndarray,
    m: AxisModel,
) -> None:
    """Tangents over a slide that began at speed v with ``left`` [s] to the end of the step."""
    h, damping = slide.time, slide.damping
    first, second = integrals(damping, h)
    of_first, of_second = _slopes_of_integrals(damping, h, first, second)
    rate = slide.pull - damping * v
    load, fall = _load_slope(slide.position, m) / m.inertia, _fall(slide, m)
    for c in range(len(kinds)):
        w = _direct(kinds[c], numbers[c], of, time, slide, m) / m.inertia
        w += fall * dv[c] - load * (dq[c] + 0.5 * left * dv[c])
        a = _of_damping(kinds[c], slide, m)
        dq[c] += dv[c] * (h - damping * second) + w * second + a * (rate * of_second - v * second)
        dv[c] += -dv[c] * damping * first + w * first + a * (rate * of_first - v * first)


@inlined
def _step(
    q: float,
    v: float,
    torque: float,
    offset: float,
    rise: float,
    time: float,
    left: float,
    of: int,
    dq: np.ndarray,
    dv: np.ndarray,
    kinds: np.ndarray,
    numbers: np.ndarray,
    m: AxisModel,
) -> tuple[float, float]:
    """Position and speed after ``left`` [s] at constant torque, with all stops and starts within.

    The torque has just risen by ``rise``, which a longer delay would shift.
    """
    stopped = 0.0
    for _ in range(MOST_EVENTS):
        slide = next_slide(q, v, torque, offset, time, left, m)
        if slide.sticks:
            for c in range(len(kinds)):
                dv[c] = 0.0
            return q, 0.0
        if v == 0.0 and stopped != 0.0:
            for c in range(len(kinds)):
                dv[c] *= slide.pull / stopped
        elif rise != 0.0 and stopped == 0.0:
            jump = slide.pull if v == 0.0 else rise / m.inertia
            for c in range(len(kinds)):
                if kinds[c] == _DELAY:
                    dv[c] -= jump
        if len(kinds):
            _carry(dq, dv, v, slide, left, time, of, kinds, numbers, m)
        q += slide.travel
        if not slide.stops:
            return q, slide.after
        v = 0.0
        stopped = slide.pull
        left -= slide.time
        if left <= SHORTEST:
            break
    return q, v


@compiled
def _move_along(
    m: AxisModel,
    first: np.ndarray,
    time: np.ndarray,
    bounds: np.ndarray,
    recordings: np.ndarray,
    data: AxisData,
    kinds: np.ndarray,
    numbers: np.ndarray,
    out: np.ndarray,
    slopes: np.ndarray,
) -> None:
    """The positions and slopes of :func:`positions_and_slopes`."""
    dq, dv = np.zeros(len(kinds)), np.zeros(len(kinds))
    last = len(data.edges) - 1
    for s in range(len(recordings)):
        of = recordings[s]
        q, v = first[s, 0], first[s, 1]
        for c in range(len(kinds)):
            dq[c] = 1.0 if kinds[c] == POSITION else 0.0
            dv[c] = 1.0 if kinds[c] == SPEED and v != 0.0 else 0.0
        t = time[bounds[s]]
        k = max(np.searchsorted(data.edges, t - m.delay, side="right") - 1, 0)
        for i in range(bounds[s], bounds[s + 1]):
            end = time[i]
            while end - t > SHORTEST:
                before = data.torque[k]
                while k < last and data.edges[k + 1] + m.delay <= t + SHORTEST:
                    k += 1
                until = min(end, t + data.step)
                if k < last:
                    until = min(until, data.edges[k + 1] + m.delay)
                torque, offset = data.torque[k], m.offsets[of]
                rise, left = torque - before, until - t
                q, v = _step(q, v, torque, offset, rise, t, left, of, dq, dv, kinds, numbers, m)
                t = until
            out[i] = q
            for c in range(len(kinds)):
                slopes[i, c] = dq[c]


def positions_and_slopes(
    model: AxisModel, first: np.ndarray, cut: Segments, keys: Sequence[Key]
) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n,) of all segments, each from its own ``first`` position and speed (s, 2).

    And their slopes (n, p) in some unknowns; "q" and "v" are the first states.
    """
    positions, slopes = np.empty(len(cut.time)), np.empty((len(cut.time), len(keys)))
    kinds, numbers = _kinds_of(keys)
    _move_along(
        model, first, cut.time, cut.bounds, cut.of, cut.data, kinds, numbers, positions, slopes
    )
    return positions, slopes


def _kinds_of(keys: Sequence[Key]) -> tuple[np.ndarray, np.ndarray]:
    """Kind of each unknown and its number: of the recording, or the order of the wave."""
    special = {"offset": OFFSET, "cos": COSINE, "sin": SINE, "q": POSITION, "v": SPEED}
    fields = {name: number for number, name in enumerate(AxisModel._fields)} | special
    pairs = [(key, 0) if isinstance(key, str) else key for key in keys]
    kinds = np.array([fields[name] for name, _ in pairs], dtype=int)
    return kinds, np.array([number for _, number in pairs], dtype=int)
