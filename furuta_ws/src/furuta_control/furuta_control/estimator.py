"""State estimate from the sensors: the paper's filter, Section 4.

The potentiometer passes a second-order low-pass filter

    ÿ = ω²(θ_measured − y) − 2ζω ẏ

whose states are the estimates of θ and θ̇. It is sampled exactly for a measurement that varies
linearly between samples (first-order hold). Arm angle and speed are measured directly.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from furuta_model.compiled import compiled
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT

from .parameters import EstimatorParameters

# The filter's memory: θ, θ̇, the previous measurement, and whether there was one.
MEMORY = 4


class LowPass(NamedTuple):
    """Sampled filter: s⁺ = a s + b_before y + b_now y⁺ with s = (θ, θ̇)."""

    a11: float
    a12: float
    a21: float
    a22: float
    b_before1: float
    b_before2: float
    b_now1: float
    b_now2: float
    passthrough: bool


def sample_filter(p: EstimatorParameters) -> LowPass:
    """Exact sampling of the filter by the exponential of the system and its linear input."""
    from scipy.linalg import expm

    omega, zeta, dt = p.filter_bandwidth, p.filter_damping, p.sample_time
    system = np.zeros((4, 4))
    system[0, 1] = 1.0
    system[1] = [-(omega**2), -2.0 * zeta * omega, omega**2, 0.0]
    system[2, 3] = 1.0 / dt
    step = expm(system * dt)
    a, constant, ramp = step[:2, :2], step[:2, 2], step[:2, 3]
    before = constant - ramp
    numbers = (*a.ravel(), *before, *ramp)
    return LowPass(*(float(number) for number in numbers), p.method == "passthrough")


@compiled
def estimate_state(
    memory: np.ndarray, measurement: np.ndarray, filter_: LowPass, estimate: np.ndarray
) -> None:
    """One sample: ``memory`` (4,) is updated, ``estimate`` (4,) of x written."""
    theta = measurement[THETA]
    if memory[3] == 0.0:
        memory[0], memory[1], memory[2], memory[3] = theta, 0.0, theta, 1.0
    angle = filter_.a11 * memory[0] + filter_.a12 * memory[1]
    angle += filter_.b_before1 * memory[2] + filter_.b_now1 * theta
    speed = filter_.a21 * memory[0] + filter_.a22 * memory[1]
    speed += filter_.b_before2 * memory[2] + filter_.b_now2 * theta
    memory[0], memory[1], memory[2] = angle, speed, theta
    estimate[PHI] = measurement[PHI]
    estimate[PHI_DOT] = measurement[PHI_DOT]
    estimate[THETA] = theta if filter_.passthrough else angle
    estimate[THETA_DOT] = measurement[THETA_DOT] if filter_.passthrough else speed
