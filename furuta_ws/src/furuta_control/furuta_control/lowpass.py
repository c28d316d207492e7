"""The paper's filter, Section 4: a low-pass on the potentiometer whose state is the speed.

    ÿ = ω²(θ_measured − y) − 2ζω ẏ

It is sampled exactly for a measurement that varies linearly between samples (first-order hold).
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

from furuta_control.parameters import EstimatorParameters
from furuta_model.compiled import inlined

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


@inlined
def smooth(memory: np.ndarray, at: int, theta: float, step: np.ndarray) -> None:
    """One sample with the measured angle ``theta`` [rad]: ``memory`` (3,) from ``at`` is moved."""
    y, y_dot, before = memory[at], memory[at + 1], memory[at + 2]
    memory[at] = step[0, 0] * y + step[0, 1] * y_dot + step[0, 2] * before + step[0, 3] * theta
    memory[at + 1] = step[1, 0] * y + step[1, 1] * y_dot + step[1, 2] * before + step[1, 3] * theta
    memory[at + 2] = theta
