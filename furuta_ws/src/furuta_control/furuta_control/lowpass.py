"""The paper's filter, Section 4: a low-pass on the potentiometer whose state is the speed.

    ÿ = ω²(θ_measured − y) − 2ζω ẏ

It is sampled exactly for a measurement that varies linearly between samples (first-order hold).
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

from furuta_model.compiled import compiled

from .parameters import EstimatorParameters

# The filter's memory: θ, θ̇, and the previous measurement.
MEMORY = 3


def sample_lowpass(p: EstimatorParameters) -> np.ndarray:
    """One sample: (θ, θ̇)⁺ is the result (2, 4) times (θ, θ̇, measured before, measured now).

    Exact, by the exponential of the system and its linear input.
    """
    omega, zeta, dt = p.filter_bandwidth, p.filter_damping, p.sample_time
    system = np.zeros((4, 4))
    system[0, 1] = 1.0
    system[1] = [-(omega**2), -2.0 * zeta * omega, omega**2, 0.0]
    system[2, 3] = 1.0 / dt
    step = expm(system * dt)[:2]
    # The input's states are its value before and its rise; the rise is the difference to now.
    step[:, 2] -= step[:, 3]
    return np.ascontiguousarray(step)


@compiled
def smooth(memory: np.ndarray, theta: float, step: np.ndarray) -> None:
    """One sample with the measured angle ``theta`` [rad]: ``memory`` (3,) is moved."""
    a, b = step
    angle = a[0] * memory[0] + a[1] * memory[1] + a[2] * memory[2] + a[3] * theta
    speed = b[0] * memory[0] + b[1] * memory[1] + b[2] * memory[2] + b[3] * theta
    memory[0], memory[1], memory[2] = angle, speed, theta
