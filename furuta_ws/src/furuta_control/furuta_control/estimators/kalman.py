r"""Kalman filter on encoder, tachometer, potentiometer and applied torque.

The arm angle enters neither the dynamics nor the other measurements, so the filter has two separate
parts. The first is a stationary Kalman filter for s = (φ̇, θ, θ̇, F): the linear model (2) with the
friction F as a random walk:

.. math::
    \dot x = Ax + B(u - F), \qquad \dot F = w_F, \qquad \ddot θ = \ldots + w_θ

w_θ represents model errors of the pendulum. Without it the filter would trust the model more than
the sensor, and a model error of a few percent would let the pendulum fall. The quantisation of the
converters is treated as noise with a variance of a twelfth of a step squared.

The second part is the arm angle: φ̇ integrated and kept within half a count of the encoder. The
encoder only says which count the arm is in. The angle is therefore exact whenever the count
changes, and in between as accurate as the tachometer.

Both parts are bounded for bounded measurements: the error of the first is linear and stable, and
the second stays within its count.
"""

from typing import NamedTuple

import numpy as np

from furuta_control.estimators.method import NominalRig
from furuta_model.compiled import inlined
from furuta_model.linear import KalmanParameters, linearize
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

# Smallest variance of a measurement [rad², rad²/s²]; the design needs some noise.
SMALLEST_VARIANCE = 1e-14
# Inputs of one sample: the five signals, then applied torque, tachometer, potentiometer.
INPUTS = SIGNALS + 3


class Kalman(NamedTuple):
    """The sampled filter: ``step`` (5, 8) of one sample, and half an encoder count [rad].

    ``prediction`` (3, 6) gives φ, φ̇ and θ of the next sample from the estimate and the torque.
    """

    step: np.ndarray
    prediction: np.ndarray
    half_count: float


def design(rig: NominalRig, p: KalmanParameters) -> Kalman:
    """The filter for the nominal rig."""
    dynamics, torque, covariance = _sampled(rig, p)
    gain = _gain(dynamics[1:, 1:], covariance[1:, 1:], rig.sensors)
    step = np.zeros((SIGNALS, INPUTS))
    step[:, :SIGNALS] = dynamics
    step[:, SIGNALS] = torque
    # Correct by the innovation: measured minus predicted tachometer and potentiometer.
    predicted = step[[PHI_DOT, THETA]]
    step[1:] -= gain @ predicted
    step[1:, SIGNALS + 1 :] = gain
    prediction = np.column_stack([dynamics, torque])[: THETA + 1]
    return Kalman(step, prediction, half_count(rig.sensors))


def stationary_gain(rig: NominalRig, p: KalmanParameters) -> np.ndarray:
    """Stationary Kalman gain (4, 2) of (φ̇, θ, θ̇, F) for tachometer and potentiometer."""
    dynamics, _, covariance = _sampled(rig, p)
    return _gain(dynamics[1:, 1:], covariance[1:, 1:], rig.sensors)


def half_count(sensors: Sensors) -> float:
    """Half an encoder count [rad], 0 without quantisation."""
    return 0.5 * sensors.encoder_count


def _sampled(rig: NominalRig, p: KalmanParameters) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Transition (5, 5), input (5,) and covariance (5, 5) of x and F over one sample.

    Each is computed by one matrix exponential (Van Loan).
    """
    from scipy.linalg import expm  # slow; not every node needs it

    a, b = linearize(rig.model, rig.viscous)
    dt = rig.sample_time
    system = np.zeros((SIGNALS + 1, SIGNALS + 1))
    system[:RIGID_STATES, :RIGID_STATES] = a
    system[:RIGID_STATES, OBSERVED_FRICTION], system[:RIGID_STATES, SIGNALS] = -b, b
    sampled = expm(system * dt)
    density = np.zeros((SIGNALS, SIGNALS))
    density[OBSERVED_FRICTION, OBSERVED_FRICTION] = p.friction_process_noise**2
    density[THETA_DOT, THETA_DOT] = p.pendulum_process_noise**2
    free = system[:SIGNALS, :SIGNALS]
    exponential = expm(np.block([[-free, density], [np.zeros_like(free), free.T]]) * dt)
    covariance = exponential[SIGNALS:, SIGNALS:].T @ exponential[:SIGNALS, SIGNALS:]
    return sampled[:SIGNALS, :SIGNALS], sampled[:SIGNALS, SIGNALS], covariance


def _gain(dynamics: np.ndarray, process: np.ndarray, sensors: Sensors) -> np.ndarray:
    """Stationary Kalman gain (4, 2) for tachometer and potentiometer."""
    from scipy.linalg import solve_discrete_are

    outputs = np.zeros((2, 4))
    outputs[0, PHI_DOT - 1] = outputs[1, THETA - 1] = 1.0
    _, *variances = sensors.variances
    noise = np.diag([max(variance, SMALLEST_VARIANCE) for variance in variances])
    covariance = solve_discrete_are(dynamics.T, outputs.T, process, noise)
    innovation = outputs @ covariance @ outputs.T + noise
    gain: np.ndarray = np.linalg.solve(innovation, outputs @ covariance).T
    return gain


@inlined
def update(x: np.ndarray, measurement: np.ndarray, p: Kalman) -> None:
    """Move the estimate ``x`` by one sample with a ``measurement`` (5,)."""
    step, phi, phi_dot = p.step, x[PHI], x[PHI_DOT]
    theta, theta_dot, friction = x[THETA], x[THETA_DOT], x[OBSERVED_FRICTION]
    for i in range(SIGNALS):
        x[i] = (
            step[i, PHI] * phi
            + step[i, PHI_DOT] * phi_dot
            + step[i, THETA] * theta
            + step[i, THETA_DOT] * theta_dot
            + step[i, OBSERVED_FRICTION] * friction
            + step[i, SIGNALS] * measurement[APPLIED_TORQUE]
            + step[i, SIGNALS + 1] * measurement[PHI_DOT]
            + step[i, SIGNALS + 2] * measurement[THETA]
        )
    x[PHI] = within_count(x[PHI], measurement[PHI], p.half_count)


@inlined
def within_count(angle: float, measured: float, half_count: float) -> float:
    """The arm angle [rad], kept within half a count of the encoder."""
    return min(max(angle, measured - half_count), measured + half_count)


@inlined
def predict(x: np.ndarray, torque: float, p: Kalman, predicted: np.ndarray) -> None:
    """Write φ, φ̇ and θ of the next sample to ``predicted``, for the ``torque`` [V] until then."""
    for i in range(THETA + 1):
        predicted[i] = p.prediction[i, SIGNALS] * torque
        for j in range(SIGNALS):
            predicted[i] += p.prediction[i, j] * x[j]
