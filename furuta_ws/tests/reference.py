"""Equations (1) and (5) of the paper in plain Python, as a reference for the compiled code."""

import numpy as np
from scipy.integrate import solve_ivp

from furuta_model.friction.parameters import Friction
from furuta_model.pendulum import FurutaPendulum


def accelerations(v: float, theta: float, w: float, torque: float, p: FurutaPendulum) -> np.ndarray:
    """(φ̈, θ̈) from (1) as a mass matrix times accelerations equal to torques."""
    s, c = np.sin(theta), np.cos(theta)
    mass = [[p.alpha + p.beta * s**2, p.gamma * c], [p.gamma * c, p.beta]]
    arm = torque - 2 * p.beta * c * s * v * w + p.gamma * s * w**2
    return np.linalg.solve(mass, [arm, p.beta * c * s * v**2 + p.delta * s])


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


def plant_after(
    x: np.ndarray, torque: float, seconds: float, body: FurutaPendulum, lugre: Friction
) -> np.ndarray:
    """The plant state (5,) after ``seconds`` by an implicit solver at tight tolerance."""
    solution = solve_ivp(
        plant_rate,
        (0, seconds),
        x,
        method="Radau",
        args=(torque, body, lugre),
        rtol=1e-8,
        atol=1e-11,
    )
    return solution.y[:, -1]


def loop_rate(
    t: float, x: np.ndarray, gains: np.ndarray, body: FurutaPendulum, lugre: Friction
) -> list[float]:
    """Derivative of the plant state with continuous feedback u = l·x."""
    return plant_rate(t, x, float(gains @ x[:4]), body, lugre)


def closed_loop(
    x: np.ndarray, gains: np.ndarray, seconds: float, body: FurutaPendulum, lugre: Friction
) -> np.ndarray:
    """Trajectory (n, 5) of the closed loop from ``x``, in steps of at most 5 ms."""
    solution = solve_ivp(
        loop_rate,
        (0, seconds),
        x,
        method="Radau",
        args=(gains, body, lugre),
        rtol=1e-7,
        atol=1e-10,
        max_step=0.005,
    )
    return solution.y.T


def upper_reversals(
    x: np.ndarray, gains: np.ndarray, seconds: float, body: FurutaPendulum, lugre: Friction
) -> np.ndarray:
    """States (n, 5) where the arm stops moving forward."""

    class Speed:
        direction = -1

        def __call__(self, t: float, x: np.ndarray, *_: object) -> float:
            return float(x[1])

    solution = solve_ivp(
        loop_rate,
        (0, seconds),
        x,
        method="Radau",
        args=(gains, body, lugre),
        rtol=1e-8,
        atol=1e-11,
        events=Speed(),
    )
    return solution.y_events[0]
