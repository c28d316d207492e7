"""State estimate from the sensors: the paper's filter, Section 4.

The potentiometer passes a second-order low-pass filter

    ÿ = ω²(θ_measured − y) − 2ζω ẏ

whose states are the estimates of θ and θ̇. It is sampled exactly for a measurement that varies
linearly between samples (first-order hold). Arm angle and speed are measured directly.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

from furuta_model.compiled import compiled
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT

from .parameters import EstimatorParameters

# The filter's memory: θ, θ̇, the previous measurement, and whether there was one.
MEMORY = 4


class LowPass(NamedTuple):
    """Sampled filter: (θ, θ̇)⁺ = ``step`` (2, 4) times (θ, θ̇, measured before, measured now)."""

    step: np.ndarray
    passthrough: bool


def sample_filter(p: EstimatorParameters) -> LowPass:
    """Exact sampling of the filter by the exponential of the system and its linear input."""
    omega, zeta, dt = p.filter_bandwidth, p.filter_damping, p.sample_time
    system = np.zeros((4, 4))
    system[0, 1] = 1.0
    system[1] = [-(omega**2), -2.0 * zeta * omega, omega**2, 0.0]
    system[2, 3] = 1.0 / dt
    step = expm(system * dt)[:2]
    # The input's states are its value before and its rise; the rise is the difference to now.
    step[:, 2] -= step[:, 3]
    return LowPass(np.ascontiguousarray(step), p.method == "passthrough")


@compiled
def estimate_state(
    memory: np.ndarray, measurement: np.ndarray, filter_: LowPass, estimate: np.ndarray
) -> None:
    """One sample: ``memory`` (4,) is updated, ``estimate`` (4,) of x written."""
    theta = measurement[THETA]
    if memory[3] == 0.0:
        memory[0], memory[1], memory[2], memory[3] = theta, 0.0, theta, 1.0
    a, b = filter_.step
    angle = a[0] * memory[0] + a[1] * memory[1] + a[2] * memory[2] + a[3] * theta
    speed = b[0] * memory[0] + b[1] * memory[1] + b[2] * memory[2] + b[3] * theta
    memory[0], memory[1], memory[2] = angle, speed, theta
    estimate[PHI] = measurement[PHI]
    estimate[PHI_DOT] = measurement[PHI_DOT]
    estimate[THETA] = theta if filter_.passthrough else angle
    estimate[THETA_DOT] = measurement[THETA_DOT] if filter_.passthrough else speed
