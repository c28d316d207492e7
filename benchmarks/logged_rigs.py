r"""Draws rotary pendulums whose arm truly sticks, and logs of them.

With k = cos θ, s = sin θ, upright at θ = 0, in volts:

.. math::
    (α + βs^2)\ddot φ + γk\ddot θ &= u - c\dot φ - F_\pm\,\mathrm{sgn}\,\dot φ + γs\dot θ^2
        - 2βsk\dot φ\dot θ - \sum(c_n\cos nφ + s_n\sin nφ) \\
    γk\ddot φ + β\ddot θ &= βsk\dot φ^2 + δs - c_2\dot θ

A stuck arm stays where it is while friction can hold what drive and pendulum demand.
"""

from math import cos, pi, sin

import numba
import numpy as np
from logged_motions import Logged, log_uniform

STEP, HALVINGS = 25e-6, 40
MOVES = ("steps", "sine", "chirp", "multisine", "step and back")


@numba.njit(cache=True, error_model="numpy")
def _rates(x: np.ndarray, u: float, p: np.ndarray, waves: np.ndarray, side: float) -> np.ndarray:
    """Derivatives of (φ, φ̇, θ, θ̇); with ``side`` 0 the arm is stuck, and the second is what is
    missing to hold it.
    """
    alpha, beta, gamma, delta, viscous, forward, backward, damping = p
    s, k, v, w = sin(x[2]), cos(x[2]), x[1], x[3]
    arm = u - viscous * v + gamma * s * w * w - 2.0 * beta * s * k * v * w
    for n in range(len(waves)):
        arm -= waves[n, 1] * cos(waves[n, 0] * x[0]) + waves[n, 2] * sin(waves[n, 0] * x[0])
    arm -= forward if side > 0.0 else -backward if side < 0.0 else 0.0
    joint = beta * s * k * v * v + delta * s - damping * w
    if side == 0.0:
        return np.array([0.0, arm - gamma * k * joint / beta, w, joint / beta])
    a, b = alpha + beta * s * s, gamma * k
    size = a * beta - b * b
    return np.array([v, (beta * arm - b * joint) / size, w, (a * joint - b * arm) / size])


@numba.njit(cache=True, error_model="numpy")
def _step(
    x: np.ndarray, u: float, p: np.ndarray, waves: np.ndarray, side: float, h: float
) -> np.ndarray:
    moves = np.array([1.0, 1.0 if side != 0.0 else 0.0, 1.0, 1.0])
    k1 = moves * _rates(x, u, p, waves, side)
    k2 = moves * _rates(x + 0.5 * h * k1, u, p, waves, side)
    k3 = moves * _rates(x + 0.5 * h * k2, u, p, waves, side)
    k4 = moves * _rates(x + h * k3, u, p, waves, side)
    return x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


@numba.njit(cache=True, error_model="numpy")
def _moved(
    x: np.ndarray, commands: np.ndarray, every: int, p: np.ndarray, waves: np.ndarray
) -> np.ndarray:
    """States (n, 4) at each sample; commands (n * every,) hold for a step."""
    out = np.empty((len(commands) // every, 4))
    for n in range(len(out) * every):
        if n % every == 0:
            out[n // every] = x
        left = STEP
        for _ in range(8):
            side = np.sign(x[1])
            if side == 0.0:
                missing = _rates(x, commands[n], p, waves, 0.0)[1]
                if missing > p[5]:
                    side = 1.0
                elif missing < -p[6]:
                    side = -1.0
            there, span = _step(x, commands[n], p, waves, side, left), left
            if side * there[1] < 0.0:
                low, high = 0.0, left
                for _ in range(HALVINGS):
                    middle = 0.5 * (low + high)
                    turned = side * _step(x, commands[n], p, waves, side, middle)[1] < 0.0
                    low, high = (low, middle) if turned else (middle, high)
                there, span = _step(x, commands[n], p, waves, side, low), max(low, 1e-9)
                there[1] = 0.0
            x = there
            left -= span
            if left <= 1e-9:
                break
    return out


def logged_rig(seed: int) -> tuple[Logged, np.ndarray]:
    """A random rig, its log, and what was measured (n, 4) of (φ, φ̇, θ, θ̇), speeds not."""
    r = np.random.default_rng((29, seed))
    kind, rate = MOVES[seed % len(MOVES)], float(r.choice((200.0, 250.0, 500.0, 1000.0)))
    beta = log_uniform(r, 8e-4, 8e-3)
    alpha, omega = beta * r.uniform(1.5, 6.0), r.uniform(5.0, 12.0)
    gamma = r.uniform(0.3, 0.8) * np.sqrt(alpha * beta)
    coulomb, asymmetry = r.uniform(0.05, 0.25), r.uniform(-0.25, 0.25)
    viscous, damping = alpha / r.uniform(0.02, 0.06), 2.0 * r.uniform(0.003, 0.02) * omega * beta
    p = np.array(
        [
            *(alpha, beta, gamma, omega**2 * beta, viscous),
            *(coulomb * (1.0 + asymmetry), coulomb * (1.0 - asymmetry), damping),
        ]
    )
    orders = r.choice(np.arange(2, 25), int(r.integers(0, 3)), replace=False)
    waves = np.array([(n, *(0.05 * r.standard_normal(2))) for n in orders]).reshape(-1, 3)
    seconds, every = r.uniform(6.0, 10.0), round(1.0 / (rate * STEP))
    time = np.arange(int(seconds * rate)) / rate
    volts = r.uniform(1.0, 5.0) * _shape(r, kind, np.maximum(time - 0.4, 0.0)) * (time > 0.4)
    late = int(r.uniform(0.0, 0.005) / STEP)
    commands = np.append(np.zeros(late), np.repeat(volts, every))[: every * len(time)]
    states = _moved(np.array([0.0, 0.0, pi, 0.0]), commands, every, p, waves)
    counts, measured = (
        float(r.choice((1024.0, 2048.0, 4096.0, 8192.0))),
        np.full_like(states, np.nan),
    )
    for column in (0, 2):
        step = 2.0 * pi / counts
        measured[:, column] = step * np.round(states[:, column] / step)
    names = ("alpha", "beta", "gamma", "delta", "viscous")
    values = dict(zip(names, map(float, p), strict=False)) | {
        "natural_frequency_rad_s": float(omega),
        "coulomb": float(coulomb),
        "asymmetry": float(asymmetry),
        "pendulum_viscous": float(damping),
    }
    traits = ("waves",) if len(waves) else ("no waves",)
    return Logged(kind, traits, values, time, measured[:, 0], volts), measured


def _shape(r: np.random.Generator, kind: str, time: np.ndarray) -> np.ndarray:
    """A command (n,) within ±1."""
    if kind == "sine":
        return np.asarray(np.sin(2.0 * pi * r.uniform(0.5, 1.5) * time))
    if kind == "chirp":
        return np.asarray(np.sin(2.0 * pi * (0.3 + 0.2 * time) * time))
    if kind == "multisine":
        waves = np.sin(2.0 * pi * np.outer(time, r.uniform(0.3, 3.0, 4)) + r.uniform(0.0, 6.0, 4))
        return np.asarray(waves.mean(axis=1) * 1.5)
    lasts = r.uniform(0.4, 1.0) if kind == "steps" else r.uniform(1.5, 2.5)
    levels = (
        r.choice((-1.0, -0.6, 0.6, 1.0), 100) if kind == "steps" else np.resize((1.0, -1.0), 100)
    )
    return np.asarray(levels[(time // lasts).astype(int)])
