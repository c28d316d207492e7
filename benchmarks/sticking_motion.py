r"""Moves an axis whose friction truly sticks, in steps of at most 25 µs in which stops are located.

.. math::
    J\dot v = τ - (B ± D)v - (1 ± a)\,(F_C + F_S e^{-(v/v_s)^2} + Cv^2 + L|τ|)\,\mathrm{sgn}\,v
              - f_0 - f_1 t - g_s\sin q - g_c\cos q - kq - \sum(c_n\cos nq + s_n\sin nq)

± is the sign of v. A slide is integrated by the classical Runge-Kutta method. The torque follows
the command with a lag of first order, or is a spring to it, within a limit. It shares no
code with the identification that it judges.
"""

from math import cos, exp, sin
from typing import NamedTuple

import numba
import numpy as np

# Longest step, and shortest one [s].
STEP, SHORTEST = 25e-6, 1e-12
# Halvings by which a stop is located within a step.
HALVINGS = 40


class Axis(NamedTuple):
    """Parameters of the equation above [kg m², N m, rad, s], and how its torque follows a command.

    ``waves`` (w, 3) are order, cosine and sine. A ``stribeck_velocity`` of 0 is friction that falls
    at once. With a ``stiffness`` the command is a goal, and the torque at most ``limit``.
    """

    inertia: float = 1.0
    alpha0: float = 0.0
    viscous: float = 0.0
    offset: float = 0.0
    gravity_sin: float = 0.0
    gravity_cos: float = 0.0
    spring: float = 0.0
    alpha1: float = 0.0
    stribeck_velocity: float = 0.0
    asymmetry: float = 0.0
    viscous_difference: float = 0.0
    drag: float = 0.0
    drift: float = 0.0
    load_friction: float = 0.0
    lag: float = 0.0
    stiffness: float = 0.0
    limit: float = 0.0
    waves: np.ndarray = np.zeros((0, 3))


@numba.njit(cache=True, error_model="numpy")
def _torque(a: Axis, q: float, driven: float) -> float:
    if a.stiffness == 0.0:
        return driven
    return min(max(a.stiffness * (driven - q), -a.limit), a.limit)


@numba.njit(cache=True, error_model="numpy")
def _driven(a: Axis, driven: float, command: float, after: float) -> float:
    if a.lag == 0.0:
        return command
    return command + (driven - command) * exp(-after / a.lag)


@numba.njit(cache=True, error_model="numpy")
def _net(a: Axis, q: float, torque: float, time: float) -> float:
    """The torque without friction."""
    load = a.offset + a.drift * time + a.spring * q + a.gravity_sin * sin(q)
    load += a.gravity_cos * cos(q)
    for k in range(a.waves.shape[0]):
        angle = a.waves[k, 0] * q
        load += a.waves[k, 1] * cos(angle) + a.waves[k, 2] * sin(angle)
    return torque - load


@numba.njit(cache=True, error_model="numpy")
def _level(a: Axis, v: float, torque: float, side: float) -> float:
    """Friction in a direction: at v = 0 the one that must be exceeded."""
    level = a.alpha0 + a.drag * v * v + a.load_friction * abs(torque)
    if a.stribeck_velocity > 0.0:
        level += a.alpha1 * exp(-((v / a.stribeck_velocity) ** 2))
    return (1.0 + side * a.asymmetry) * level


@numba.njit(cache=True, error_model="numpy")
def _rate(a: Axis, q: float, v: float, driven: float, time: float, side: float) -> float:
    torque = _torque(a, q, driven)
    net = _net(a, q, torque, time) - (a.viscous + side * a.viscous_difference) * v
    return (net - side * _level(a, v, torque, side)) / a.inertia


@numba.njit(cache=True, error_model="numpy")
def _slide(
    a: Axis, q: float, v: float, driven: float, command: float, time: float, h: float, side: float
) -> tuple[float, float]:
    """Position and speed after h of a slide to one side."""
    half, whole = _driven(a, driven, command, 0.5 * h), _driven(a, driven, command, h)
    v1, a1 = v, _rate(a, q, v, _driven(a, driven, command, 0.0), time, side)
    v2 = v + 0.5 * h * a1
    a2 = _rate(a, q + 0.5 * h * v1, v2, half, time + 0.5 * h, side)
    v3 = v + 0.5 * h * a2
    a3 = _rate(a, q + 0.5 * h * v2, v3, half, time + 0.5 * h, side)
    v4 = v + h * a3
    a4 = _rate(a, q + h * v3, v4, whole, time + h, side)
    q += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4)
    return q, v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)


@numba.njit(cache=True, error_model="numpy")
def moved(
    a: Axis, state: tuple[float, float, float], command: float, time: float, span: float
) -> tuple[float, float, float]:
    """Position, speed and what drives it, a ``span`` [s] after a ``time`` [s]."""
    q, v, driven = state
    steps = max(int(np.ceil(span / STEP)), 1)
    h = span / steps
    for step in range(steps):
        left = h
        while left > SHORTEST:
            t = time + (step + 1) * h - left
            side, sticks = np.sign(v), False
            if v == 0.0:
                torque = _torque(a, q, _driven(a, driven, command, 0.0))
                net = _net(a, q, torque, t)
                side = 1.0 if net > 0.0 else -1.0
                level = _level(a, 0.0, torque, side)
                if a.stribeck_velocity == 0.0:
                    level += (1.0 + side * a.asymmetry) * a.alpha1
                sticks = abs(net) <= level
            span_now = left
            if not sticks:
                there, after = _slide(a, q, v, driven, command, t, left, side)
                if side * after < 0.0:
                    low, high = 0.0, left
                    for _ in range(HALVINGS):
                        middle = 0.5 * (low + high)
                        _, after = _slide(a, q, v, driven, command, t, middle, side)
                        low, high = (low, middle) if side * after < 0.0 else (middle, high)
                    there, after = _slide(a, q, v, driven, command, t, low, side)[0], 0.0
                    # A slide that ends where it begins does not begin.
                    span_now = low if low > SHORTEST else left
                q, v = there, after
            driven = _driven(a, driven, command, span_now)
            left -= span_now
    return q, v, driven
