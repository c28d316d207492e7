"""Folds of hunting cycles by shooting with scipy: no code of the engine.

A symmetric cycle of amplitude e repeats after half a period with opposite sign. For each e the
damping k_d of the cycle through e is solved for; the fold is the largest k_d(e).
"""

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve, minimize_scalar

from furuta.axis.axis import Axis, Pid

NUDGE = 1e-4  # time after a breakaway at which v is followed from its series
TIGHT = {"rtol": 1e-10, "atol": 1e-12}


def stribeck_fold(axis: Axis, pid: Pid, sizes: tuple[float, float]) -> float:
    """The largest k_d of a cycle that sticks, of amplitude within ``sizes``."""

    def excess(kd: float, e: float) -> float:
        return stribeck_reach(axis, pid._replace(kd=kd), e) - e

    return _largest(lambda e: brentq(excess, 0.8, 1.6, args=(e,), xtol=1e-9), sizes)


def stribeck_reach(axis: Axis, pid: Pid, e: float) -> float:
    """How far beyond its reference an axis slides that has stuck at e > 0; e again in a cycle."""
    p, m, vs = axis.friction, axis.inertia, axis.friction.stribeck_velocity

    def rate(_: float, y: np.ndarray) -> list[float]:
        v, error, integral = y
        friction = p.alpha0 + p.alpha1 * np.exp(-((v / vs) ** 2)) + p.viscous * v
        return [(pid.kp * error + pid.ki * integral - pid.kd * v - friction) / m, -v, error]

    nudge = min(NUDGE, 1e-3 * vs)
    integral = (p.alpha0 + p.alpha1 - pid.kp * e) / pid.ki
    v = pid.ki * e * nudge**2 / (2 * m)
    start = [v, e - v * nudge / 3, integral + e * nudge]
    # Longer steps could pass over the speeds at which the level changes.
    steps = {"max_step": vs * m / (p.alpha0 + p.alpha1), "rtol": 1e-10, "atol": 1e-13 * min(vs, 1)}
    out = solve_ivp(rate, (0.0, 1e3), start, "DOP853", events=_falling(0), **steps)
    return float(-out.y[1, -1])


def lugre_fold(axis: Axis, pid: Pid, sizes: tuple[float, float]) -> float:
    """The largest k_d of a cycle under LuGre of amplitude within ``sizes``."""
    p, m = axis.friction, axis.inertia
    guess = np.array([1.3 - pid.kp * np.mean(sizes), -1.2, 1.0])

    def change(unknown: np.ndarray, e: float) -> list[float]:
        """Change of error, k_i ∫e and σ₀z over half a period, from the reversal at e."""
        kd = unknown[2]

        def rate(_: float, y: np.ndarray) -> list[float]:
            v, error, integral, force = y
            level = p.alpha0 + p.alpha1 * np.exp(-((v / p.stribeck_velocity) ** 2))
            z_dot = v - abs(v) * force / level
            friction = force + p.sigma1 * z_dot
            accelerated = (pid.kp * error + integral - kd * v - friction) / m
            return [accelerated, -v, pid.ki * error, p.sigma0 * z_dot]

        start = [0.0, e, unknown[0], unknown[1]]
        reversal = _falling(0, beyond=0.5 * e)
        out = solve_ivp(rate, (0.0, 1e3), start, "LSODA", events=reversal, **TIGHT)
        return [float(out.y[i, -1] + start[i]) for i in (1, 2, 3)]

    def damping(e: float) -> float:
        guess[:] = fsolve(change, guess, args=(e,), xtol=1e-9)
        return float(guess[2])

    return _largest(damping, sizes)


def _falling(index: int, beyond: float = np.inf) -> Callable[[float, np.ndarray], float]:
    """The event v = 0 from above, once the error is below ``beyond``."""

    def event(_: float, y: np.ndarray) -> float:
        return float(y[index]) if y[1] < beyond else 1.0

    event.terminal, event.direction = True, -1.0  # type: ignore[attr-defined]
    return event


def _largest(damping: Callable[[float], float], sizes: tuple[float, float]) -> float:
    found = minimize_scalar(lambda e: -damping(e), bounds=sizes, options={"xatol": 1e-4})
    return float(-found.fun)
