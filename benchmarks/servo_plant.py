"""A servo axis that truly sticks, with its controller: the truth of hunting_axes.py.

In units of its own, by Runge and Kutta. Stops are located within a sample.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

SUBSTEPS = 20
# An error, relative to the start, from which an axis does not come back.
LOST = 100.0


class Truth(NamedTuple):
    """A plant [kg m², N m, rad/s]: ``added`` friction at rest falls at ``velocity``; 0: at once."""

    inertia: float
    coulomb: float
    added: float
    velocity: float
    viscous: float
    load: float


class Control(NamedTuple):
    """Gains on error, speed and the integrals of both, filter, rule of the integral, known load."""

    error: float
    speed: float
    of_error: float
    of_speed: float
    filter_time: float
    band: float
    resets: bool
    limit: float
    load: float


@njit
def rate(v: float, way: float, torque: float, a: Truth) -> float:
    """Acceleration [rad/s²] while the axis slides one way (±1)."""
    size = max(way * v, 0.0)
    level = a.coulomb
    if a.velocity > 0.0:
        level += a.added * np.exp(-((size / a.velocity) ** 2))
    return (torque - a.load - way * level - a.viscous * v) / a.inertia


@njit
def after(v: float, way: float, torque: float, h: float, a: Truth) -> tuple[float, float]:
    """Way [rad] and speed after h [s], by Runge and Kutta."""
    k1 = rate(v, way, torque, a)
    k2 = rate(v + 0.5 * h * k1, way, torque, a)
    k3 = rate(v + 0.5 * h * k2, way, torque, a)
    k4 = rate(v + h * k3, way, torque, a)
    return h * (v + h * (k1 + k2 + k3) / 6.0), v + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0


@njit
def moved(q: float, v: float, torque: float, dt: float, a: Truth) -> tuple[float, float]:
    """Position and speed after a sample under a constant torque; the axis stops where v = 0."""
    left, breakaway = dt, a.coulomb + a.added
    while left > 0.0:
        net = torque - a.load
        if v == 0.0 and abs(net) <= breakaway * (1.0 + 1e-12):
            break
        way = np.sign(v) if v != 0.0 else np.sign(net)
        h = min(left, dt / SUBSTEPS)
        if a.velocity > 0.0 and abs(v) < 4.0 * a.velocity:
            h = max(min(h, 0.1 * a.velocity * a.inertia / (abs(net) + breakaway)), 1e-4 * dt)
        step, speed = after(v, way, torque, h, a)
        if speed * way <= 0.0:
            low, high = 0.0, h
            while high - low > 1e-9 * dt:
                h = 0.5 * (low + high)
                step, speed = after(v, way, torque, h, a)
                low, high = (h, high) if speed * way > 0.0 else (low, h)
            speed = 0.0
        q, v, left = q + step, speed, left - max(h, 1e-9 * dt)
    return q, v


@njit
def run(
    a: Truth,
    c: Control,
    count: float,
    dt: float,
    delay: int,
    start: float,
    integral: float,
    out: np.ndarray,
) -> None:
    """Position and torque (2, n) at each sample, released at rest from ``start`` [rad]."""
    q, v, speed, last = start, 0.0, 0.0, 0.0
    before = count * np.floor(start / count + 0.5)
    for k in range(out.shape[1]):
        measured = count * np.floor(q / count + 0.5)
        e = -measured
        speed += dt / (dt + c.filter_time) * ((measured - before) / dt - speed)
        if c.resets and (e * last < 0.0 or c.of_error == 0.0):
            integral = c.load
        if abs(e) >= c.band:
            integral += dt * (c.of_error * e + c.of_speed * speed)
        if measured != before and c.limit > 0.0:
            integral = min(max(integral, c.load - c.limit), c.load + c.limit)
        before = measured
        if e != 0.0:
            last = e
        out[0, k] = q
        out[1, k] = c.error * e + c.speed * speed + integral
        q, v = moved(q, v, out[1, max(k - delay, 0)] if k >= delay else integral, dt, a)
        if not abs(q) < LOST * abs(start):
            out[:, k:] = q
            return
