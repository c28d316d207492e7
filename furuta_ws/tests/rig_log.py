"""A simulated log of a real rig, with equations and an integrator of its own."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from furuta_recordings.recording import Recording


class Truth(NamedTuple):
    """True parameters of a small rig: coefficients of (1), joint friction, tilt, ripple, timing."""

    alpha: float = 0.0075
    beta: float = 0.0025
    gamma: float = 0.002
    delta: float = 0.22
    viscous: float = 0.25
    coulomb: float = 0.12
    pendulum_viscous: float = 4e-4
    tilt: tuple[float, float] = (-0.04, 0.02)
    ripple: float = 0.03
    delay: float = 0.0025
    lag: float = 0.008
    zero: float = 0.05


TRUTH = Truth()


def swing(kind: str, truth: Truth = TRUTH, seconds: float = 4.0, seed: int = 0) -> Recording:
    """Simulate the log of a hanging pendulum at 500 Hz, with jitter and noise.

    ``kind`` is sine (2 V, 1 Hz) or step (4 V, logged once a second, the first one missing). The
    logged pendulum angle is 0 hanging and has the opposite sign. The mass matrix is inverted by
    numpy, and friction is a steep arctangent.
    """
    rng = np.random.default_rng(seed)
    time = np.cumsum(
        np.full(round(seconds * 500), 0.002) + rng.normal(0, 1e-4, round(seconds * 500))
    )
    on = 0.3

    def voltage(t: float) -> float:
        t -= truth.delay + on
        if t < 0:
            return 0.0
        return 4.0 if kind == "step" else 2.0 * np.sin(2 * np.pi * t)

    def slope(t: float, x: np.ndarray) -> np.ndarray:
        phi, v, theta, w, v1, v2, w1, w2 = x
        s, c = np.sin(theta), np.cos(theta)
        mass = np.array(
            [[truth.alpha + truth.beta * s * s, truth.gamma * c], [truth.gamma * c, truth.beta]]
        )
        tx, ty = truth.tilt
        along, across = tx * np.cos(phi) + ty * np.sin(phi), ty * np.cos(phi) - tx * np.sin(phi)
        friction = truth.viscous * v + truth.coulomb * 2 / np.pi * np.arctan(v / 0.01)
        arm = voltage(t) - friction + truth.ripple * np.cos(8 * phi) + truth.delta * s * along
        arm += -2 * truth.beta * c * s * v * w + truth.gamma * s * w * w
        pendulum = truth.beta * c * s * v * v + truth.delta * (s - c * across)
        pendulum -= truth.pendulum_viscous * w
        v_dot, w_dot = np.linalg.solve(mass, [arm, pendulum])
        k = 2.0 / truth.lag
        return np.array(
            [v, v_dot, w, w_dot, k * (v - v1), k * (v1 - v2), k * (w - w1), k * (w1 - w2)]
        )

    tx, ty = truth.tilt
    phi0 = 1.3
    rest = np.pi + (ty * np.cos(phi0) - tx * np.sin(phi0))
    start = [phi0, 0, rest, 0, 0, 0, 0, 0]
    solved = solve_ivp(
        slope, (0, time[-1]), start, t_eval=time, rtol=1e-6, atol=1e-8, max_step=0.01
    )
    phi, _, theta, _, _, v, _, w = solved.y
    measured = np.column_stack((phi, v, np.pi - (theta - truth.zero), -w))
    measured += rng.normal(0, [1e-4, 0.03, 1e-4, 0.03], measured.shape)
    measured[:, 0] += 2 * np.pi * 16
    if kind == "step":
        command_time, command = on + np.arange(1, int(seconds)), np.full(int(seconds) - 1, 4.0)
    else:
        command_time = on + np.arange(0, seconds - on, 0.002)
        command = 2.0 * np.sin(2 * np.pi * (command_time - on))
    return Recording(kind, time, measured, command_time, command)
