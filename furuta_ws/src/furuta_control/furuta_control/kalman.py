r"""Kalman filter on encoder, tachometer, potentiometer and applied torque.

The arm's angle enters neither the dynamics nor the other sensors' readings, so the filter falls
into two parts. A stationary Kalman filter runs on s = (φ̇, θ, θ̇, F), the linear model (2) with the
friction F as a random walk beside it:

.. math::
    \dot x = Ax + B(u - F), \qquad \dot F = w_F, \qquad \ddot θ = \ldots + w_θ

w_θ stands for what the model does not know of the pendulum; without it the filter would trust the
model more than the sensor, and a few percent of model error make the loop fall. The converters'
rounding counts as noise of a twelfth of a step squared.

The arm's angle is φ̇ integrated, kept within half a count of the encoder's reading: all that a
reading says is in which count the arm is, and it is wrong only at the edge. So the angle is
exact whenever the count changes, and between edges as good as the tachometer.

Both parts are bounded for bounded readings: the error of the first is linear and stable, the
second never leaves its count.
"""

from __future__ import annotations

from math import pi

import numpy as np
from scipy.linalg import expm, solve_discrete_are

from furuta_control.parameters import EstimatorParameters
from furuta_model.compiled import inlined
from furuta_model.linear import linearize
from furuta_model.sensors import Sensors
from furuta_model.state import EFFORT, PHI, PHI_DOT, SIGNALS, THETA, THETA_DOT

# Smallest variance of a reading [rad², rad²/s²]: a perfect sensor would leave nothing to filter.
SMALLEST_VARIANCE = 1e-14
# What one sample is computed from: the five signals, then applied torque, tachometer,
# potentiometer.
INPUTS = SIGNALS + 3


def sample_kalman(p: EstimatorParameters) -> np.ndarray:
    """One sample of the filter as a matrix (5, 8) on signals and inputs; φ not yet kept."""
    dynamics, torque, spread = _sampled(p)
    gain = _gain(dynamics[1:, 1:], spread[1:, 1:], p.sensors)
    step = np.zeros((SIGNALS, INPUTS))
    step[:, :SIGNALS] = dynamics
    step[:, SIGNALS] = torque
    # Correct by what the prediction of tachometer and potentiometer missed.
    predicted = step[[PHI_DOT, THETA]]
    step[1:] -= gain @ predicted
    step[1:, SIGNALS + 1 :] = gain
    return step


def half_count(sensors: Sensors) -> float:
    """Half the encoder's step [rad], 0 where it has none."""
    return pi / sensors.encoder_counts if sensors.encoder_counts else 0.0


def _sampled(p: EstimatorParameters) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Transition (5, 5), input (5,) and covariance (5, 5) of x and F over one sample.

    All from one exponential each (Van Loan).
    """
    a, b = linearize(p.model)
    dt = p.sample_time
    system = np.zeros((SIGNALS + 1, SIGNALS + 1))
    system[:EFFORT, :EFFORT] = a
    system[:EFFORT, EFFORT], system[:EFFORT, SIGNALS] = -b, b
    sampled = expm(system * dt)
    density = np.zeros((SIGNALS, SIGNALS))
    density[EFFORT, EFFORT] = p.friction_process_noise**2
    density[THETA_DOT, THETA_DOT] = p.pendulum_process_noise**2
    free = system[:SIGNALS, :SIGNALS]
    loan = expm(np.block([[-free, density], [np.zeros_like(free), free.T]]) * dt)
    spread = loan[SIGNALS:, SIGNALS:].T @ loan[:SIGNALS, SIGNALS:]
    return sampled[:SIGNALS, :SIGNALS], sampled[:SIGNALS, SIGNALS], spread


def _gain(dynamics: np.ndarray, spread: np.ndarray, sensors: Sensors) -> np.ndarray:
    """Stationary gain (4, 2) on tachometer and potentiometer."""
    reads = np.zeros((2, 4))
    reads[0, PHI_DOT - 1] = reads[1, THETA - 1] = 1.0
    noise = np.diag(
        [
            _variance(sensors.tachometer_noise, sensors.tachometer_range, sensors.tachometer_bits),
            _variance(
                sensors.potentiometer_noise,
                sensors.potentiometer_range,
                sensors.potentiometer_bits,
            ),
        ]
    )
    covariance = solve_discrete_are(dynamics.T, reads.T, spread, noise)
    innovation = reads @ covariance @ reads.T + noise
    gain: np.ndarray = np.linalg.solve(innovation, reads @ covariance).T
    return gain


def _variance(noise: float, full_scale: float, bits: int) -> float:
    step = 2.0 * full_scale / 2**bits if bits else 0.0
    return max(noise**2 + step**2 / 12.0, SMALLEST_VARIANCE)


@inlined
def fuse(memory: np.ndarray, measurement: np.ndarray, step: np.ndarray, half_count: float) -> None:
    """One sample: x and friction, ``memory``'s first (5,), are moved to this ``measurement``."""
    phi, phi_dot = memory[PHI], memory[PHI_DOT]
    theta, theta_dot, effort = memory[THETA], memory[THETA_DOT], memory[EFFORT]
    for i in range(SIGNALS):
        memory[i] = (
            step[i, PHI] * phi
            + step[i, PHI_DOT] * phi_dot
            + step[i, THETA] * theta
            + step[i, THETA_DOT] * theta_dot
            + step[i, EFFORT] * effort
            + step[i, SIGNALS] * measurement[EFFORT]
            + step[i, SIGNALS + 1] * measurement[PHI_DOT]
            + step[i, SIGNALS + 2] * measurement[THETA]
        )
    read = measurement[PHI]
    memory[PHI] = min(max(memory[PHI], read - half_count), read + half_count)
