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

from math import isnan, pi
from typing import Annotated, NamedTuple

import numpy as np
from scipy.linalg import expm, solve_discrete_are

from furuta_control.estimators.rig import NominalRig
from furuta_model.compiled import inlined
from furuta_model.linear import linearize
from furuta_model.parameters import About, EarlierName
from furuta_model.sensors import Sensors
from furuta_model.state import (
    APPLIED_TORQUE,
    OBSERVED_FRICTION,
    PHI,
    PHI_DOT,
    RIGID_STATES,
    SIGNALS,
    THETA,
    THETA_DOT,
)

# Smallest variance of a reading [rad², rad²/s²]: a perfect sensor would leave nothing to filter.
SMALLEST_VARIANCE = 1e-14
# What one sample is computed from: the five signals, then applied torque, tachometer,
# potentiometer.
INPUTS = SIGNALS + 3


class KalmanParameters(NamedTuple):
    """How much the filter trusts its model."""

    friction_process_noise: Annotated[
        float,
        About(
            "kalman: process noise of the friction, a random walk",
            "V/√s",
            1e-3,
            1e3,
            earlier_names=(EarlierName("friction_spread"),),
        ),
    ] = 0.3
    pendulum_process_noise: Annotated[
        float,
        About(
            "kalman: process noise of the pendulum's speed, the error of the model",
            "rad/s/√s",
            1e-3,
            1e3,
            earlier_names=(EarlierName("pendulum_spread"),),
        ),
    ] = 0.1


class Kalman(NamedTuple):
    """The filter as it runs: ``step`` (5, 8) of one sample, half the encoder's count [rad]."""

    step: np.ndarray
    half_count: float


def design(rig: NominalRig, p: KalmanParameters) -> Kalman:
    """The filter for a rig."""
    return Kalman(sample_kalman(rig, p), half_count(rig.sensors))


def sample_kalman(rig: NominalRig, p: KalmanParameters) -> np.ndarray:
    """One sample of the filter as a matrix (5, 8) on signals and inputs; φ not yet kept."""
    dynamics, torque, covariance = _sampled(rig, p)
    gain = _gain(dynamics[1:, 1:], covariance[1:, 1:], rig.sensors)
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


def _sampled(rig: NominalRig, p: KalmanParameters) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Transition (5, 5), input (5,) and covariance (5, 5) of x and F over one sample.

    All from one exponential each (Van Loan).
    """
    a, b = linearize(rig.model)
    dt = rig.sample_time
    system = np.zeros((SIGNALS + 1, SIGNALS + 1))
    system[:RIGID_STATES, :RIGID_STATES] = a
    system[:RIGID_STATES, OBSERVED_FRICTION], system[:RIGID_STATES, SIGNALS] = -b, b
    sampled = expm(system * dt)
    density = np.zeros((SIGNALS, SIGNALS))
    density[OBSERVED_FRICTION, OBSERVED_FRICTION] = p.friction_process_noise**2
    density[THETA_DOT, THETA_DOT] = p.pendulum_process_noise**2
    free = system[:SIGNALS, :SIGNALS]
    loan = expm(np.block([[-free, density], [np.zeros_like(free), free.T]]) * dt)
    covariance = loan[SIGNALS:, SIGNALS:].T @ loan[:SIGNALS, SIGNALS:]
    return sampled[:SIGNALS, :SIGNALS], sampled[:SIGNALS, SIGNALS], covariance


def _gain(dynamics: np.ndarray, process: np.ndarray, sensors: Sensors) -> np.ndarray:
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
    covariance = solve_discrete_are(dynamics.T, reads.T, process, noise)
    innovation = reads @ covariance @ reads.T + noise
    gain: np.ndarray = np.linalg.solve(innovation, reads @ covariance).T
    return gain


def _variance(noise: float, full_scale: float, bits: int) -> float:
    step = 2.0 * full_scale / 2**bits if bits else 0.0
    return max(noise**2 + step**2 / 12.0, SMALLEST_VARIANCE)


@inlined
def update(memory: np.ndarray, measurement: np.ndarray, p: Kalman) -> None:
    """One sample: the estimate, ``memory``'s first (5,), is moved to this ``measurement``.

    Without an applied torque (NaN) the filter has no past and begins anew at every sample.
    """
    if isnan(measurement[APPLIED_TORQUE]):
        for i in range(THETA_DOT):
            memory[i] = measurement[i]
        memory[THETA_DOT] = memory[OBSERVED_FRICTION] = 0.0
        return
    phi, phi_dot = memory[PHI], memory[PHI_DOT]
    theta, theta_dot, friction = memory[THETA], memory[THETA_DOT], memory[OBSERVED_FRICTION]
    for i in range(SIGNALS):
        memory[i] = (
            p.step[i, PHI] * phi
            + p.step[i, PHI_DOT] * phi_dot
            + p.step[i, THETA] * theta
            + p.step[i, THETA_DOT] * theta_dot
            + p.step[i, OBSERVED_FRICTION] * friction
            + p.step[i, SIGNALS] * measurement[APPLIED_TORQUE]
            + p.step[i, SIGNALS + 1] * measurement[PHI_DOT]
            + p.step[i, SIGNALS + 2] * measurement[THETA]
        )
    read = measurement[PHI]
    memory[PHI] = min(max(memory[PHI], read - p.half_count), read + p.half_count)
