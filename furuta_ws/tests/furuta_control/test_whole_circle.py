"""Estimator of the whole circle: the stationary filter upright and hanging, the seam, friction."""

from math import pi

import numpy as np
import reference
from estimator_steps import EstimatorSteps

from furuta_control.estimation import EstimatorMemory, EstimatorParameters, design_estimator
from furuta_control.estimators import kalman, whole_circle
from furuta_model.block import new_memory
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors

MODEL = FurutaPendulum()
SENSORS = Sensors(
    encoder_counts=4096, tachometer_range=50.0, potentiometer_range=pi, potentiometer_bits=0
)
DT = 0.001


def test_upright_it_is_the_stationary_filter() -> None:
    """For small motions one step is that of the Kalman filter for the linear model."""
    p = EstimatorParameters(method="whole_circle", sensors=SENSORS)
    reading, estimates = 1e-4 * np.array((0.3, 1.2, -0.5, np.nan, 3.0)), []
    design = design_estimator(p)
    for update, of_method in (
        (kalman.update, design.kalman),
        (whole_circle.update, design.whole_circle),
    ):
        memory = new_memory(EstimatorMemory)[0]
        memory["estimate"] = 1e-4 * np.array((0.3, 1.0, -0.4, 0.8, 2.0))
        update(memory["estimate"], reading, of_method)
        estimates.append(memory["estimate"])
    linear, nonlinear = estimates
    np.testing.assert_allclose(nonlinear, linear, rtol=1e-3, atol=1e-9)


def test_follows_a_turning_pendulum_through_the_seam() -> None:
    """Over more than a turn: angles within ±π, speeds known, also at high speed."""
    viscous = 0.5
    p = EstimatorParameters("whole_circle", sensors=SENSORS, model_viscous=viscous)
    estimator = EstimatorSteps(p)
    x, level = np.array((0.0, 0.0, -2.0, 14.0)), 0.2
    generator = np.random.default_rng(3)
    errors = []
    for k in range(3000):
        u = 2.0 * np.sin(0.004 * k)
        unknown = level * np.tanh(x[1] / 0.05)
        friction = unknown + viscous * x[1]
        v_dot, w_dot = reference.accelerations(x[1], x[2], x[3], u - friction, MODEL)
        middle = x + 0.5 * DT * np.array((x[1], v_dot, x[3], w_dot))
        v_dot, w_dot = reference.accelerations(middle[1], middle[2], middle[3], u - friction, MODEL)
        x = x + DT * np.array((middle[1], v_dot, middle[3], w_dot))
        noise = generator.normal(size=2) * (SENSORS.tachometer_noise, SENSORS.potentiometer_noise)
        theta = (x[2] + pi) % (2.0 * pi) - pi
        reading = np.array((x[0], x[1] + noise[0], theta + noise[1], np.nan, u))
        estimate, _ = estimator.step(reading)
        error = estimate[:4] - x
        errors.append((error + pi) % (2.0 * pi) - pi)
        assert abs(estimate[2]) < pi + 0.1
    assert abs(x[2]) > 2.0 * pi
    rms = np.sqrt(np.mean(np.square(errors[300:]), axis=0))
    assert np.all(rms < (0.002, 0.05, 0.003, 0.15)), rms
