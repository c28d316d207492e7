"""Equations (1) and (5) of the paper in plain Python, as a reference for the compiled code."""

from math import cos, sin
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from furuta_model.friction.parameters import Friction
from furuta_model.pendulum import FurutaPendulum


def accelerations(v: float, theta: float, w: float, torque: float, p: FurutaPendulum) -> np.ndarray:
    """(φ̈, θ̈) from (1) as a mass matrix times accelerations equal to torques."""
    s, c = sin(theta), cos(theta)
    of_arm, shared = p.alpha + p.beta * s**2, p.gamma * c
    arm = torque - 2 * p.beta * c * s * v * w + p.gamma * s * w**2
    pendulum = p.beta * c * s * v**2 + p.delta * s
    # Cramer's rule; the solver of numpy takes four times as long.
    solved = np.array((p.beta * arm - shared * pendulum, of_arm * pendulum - shared * arm))
    return solved / (of_arm * p.beta - shared**2)


def energy(x: np.ndarray, p: FurutaPendulum) -> float:
    """Kinetic plus potential energy T + V [V rad] at state ``x``, V = δ cosθ."""
    _, v, theta, w = x[:4]
    s, c = sin(theta), cos(theta)
    kinetic = 0.5 * p.alpha * v**2 + 0.5 * p.beta * (w**2 + (s * v) ** 2) + p.gamma * c * v * w
    return float(kinetic + p.delta * c)


def level(v: float, p: Friction) -> float:
    """g(v) of (5) with asymmetry."""
    return (p.alpha0 + p.alpha1 * np.exp(-((v / p.stribeck_velocity) ** 2))) * (
        1 + np.sign(v) * p.asymmetry
    )


def plant_rate(
    _: float, x: np.ndarray, torque: float, body: FurutaPendulum, lugre: Friction
) -> list[float]:
    """Derivative of (φ, φ̇, θ, θ̇, z)."""
    v, theta, w, z = x[1:]
    z_dot = v - lugre.sigma0 * abs(v) / level(v, lugre) * z
    force = lugre.sigma0 * z + lugre.sigma1 * z_dot + lugre.viscous * v
    v_dot, w_dot = accelerations(v, theta, w, torque - force, body)
    return [v, v_dot, w, w_dot, z_dot]


def loop_rate(
    t: float, x: np.ndarray, gains: np.ndarray, body: FurutaPendulum, lugre: Friction
) -> list[float]:
    """Derivative of the plant state with continuous feedback u = l·x."""
    return plant_rate(t, x, float(gains @ x[:4]), body, lugre)


def _solved(rate: Any, x: np.ndarray, seconds: float, args: Any, **options: Any) -> Any:
    """A solution by an implicit solver at tight tolerance."""
    tight = {"method": "Radau", "rtol": 1e-8, "atol": 1e-11}
    return solve_ivp(rate, (0, seconds), x, args=args, **tight, **options)


def plant_after(
    x: np.ndarray, torque: float, seconds: float, body: FurutaPendulum, lugre: Friction
) -> np.ndarray:
    """The plant state (5,) after ``seconds``."""
    return _solved(plant_rate, x, seconds, (torque, body, lugre)).y[:, -1]


def closed_loop(
    x: np.ndarray, gains: np.ndarray, seconds: float, body: FurutaPendulum, lugre: Friction
) -> np.ndarray:
    """Trajectory (n, 5) of the closed loop from ``x``, in steps of at most 5 ms."""
    return _solved(loop_rate, x, seconds, (gains, body, lugre), max_step=0.005).y.T


def upper_reversals(
    x: np.ndarray, gains: np.ndarray, seconds: float, body: FurutaPendulum, lugre: Friction
) -> np.ndarray:
    """States (n, 5) where the arm stops moving forward."""

    def speed(t: float, x: np.ndarray, *_: object) -> float:
        return float(x[1])

    speed.direction = -1  # type: ignore[attr-defined]
    return _solved(loop_rate, x, seconds, (gains, body, lugre), events=speed).y_events[0]
