"""Unusable readings: missing, impossible, clipped and outliers, for both methods.

FURUTA_FALLS sets the number of falls.
"""

import os
from itertools import product
from math import cos, inf, nan, pi

import numpy as np
import pytest
from estimator_steps import EstimatorSteps, estimates

from furuta_control.control import ControllerParameters
from furuta_control.estimation import (
    LOST,
    EstimatorParameters,
    skipped_samples,
)
from furuta_friction.compensation import ObserverParameters
from furuta_model.parameters import ParameterError
from furuta_model.sensors import Sensors
from furuta_sim.parameters import InitialState, PlantParameters
from furuta_sim.simulation.closed_loop import Loop, Record, Simulation, simulate

METHODS = ("kalman", "lowpass")
SENSORS = Sensors()
RANGE = SENSORS.potentiometer_range
# A pendulum and an arm that swing slowly, at 1 ms.
TIME = np.arange(400) * 1e-3


def swinging() -> np.ndarray:
    """Measurements (400, 5) at constant speeds and no torque."""
    measurements = np.zeros((len(TIME), 5))
    measurements[:, 0], measurements[:, 1] = 0.3 * TIME, 0.3
    measurements[:, 2], measurements[:, 3] = 0.05 * np.sin(5.0 * TIME), nan
    return measurements


@pytest.mark.parametrize("method", METHODS)
def test_a_single_bad_reading_costs_itself(method: str) -> None:
    """The estimate stays close to that without the fault, and no other reading is dropped."""
    expected, _ = estimates(swinging(), EstimatorParameters(method))
    for index, value in product(range(3), (nan, -inf, 1e300, 5.0)):
        bad = swinging()
        bad[200, index] = value
        found, unusable = estimates(bad, EstimatorParameters(method))
        assert np.flatnonzero(unusable).tolist() == [200]
        assert unusable[200] == 1 << index
        error = np.abs(found[:, :4] - expected[:, :4])
        assert np.all(error < [2e-3, 0.02, 2e-3, 0.1])
        assert np.all(error[300:] < 1e-3)


@pytest.mark.parametrize("method", METHODS)
def test_a_sensor_that_stays_silent_loses_the_estimate(method: str) -> None:
    """After 20 ms; the estimate returns with the sensor, from its reading."""
    for index in range(3):
        bad = swinging()
        bad[200:300, index] = nan
        found, unusable = estimates(bad, EstimatorParameters(method))
        assert np.all(unusable[200:220] == 1 << index)
        assert np.all(unusable[220:300] == LOST)
        assert np.all(np.isnan(found[220:300, [index, 3]]))
        assert np.all(unusable[300:] == 0)
        assert found[300, :3] == pytest.approx(bad[300, :3])
        assert np.all(np.isfinite(found[300:, :4]))


@pytest.mark.parametrize("method", METHODS)
def test_readings_that_stay_elsewhere_start_the_estimate_anew(method: str) -> None:
    """A jump is taken for an outlier at first, and believed after 20 ms."""
    moved = swinging()
    moved[200:, 2] += 0.5
    found, unusable = estimates(moved, EstimatorParameters(method))
    assert np.all(np.abs(found[200:220, 2]) < 0.1)
    assert found[220, 2] == pytest.approx(moved[220, 2])
    assert found[220, 3] == 0.0
    assert np.all(unusable[220:] == 0)


@pytest.mark.parametrize(("method", "side"), [("kalman", -1.0), ("lowpass", 1.0)])
def test_clipped_pendulum_is_out_of_sight(method: str, side: float) -> None:
    """At the end of the potentiometer the angle is known to be beyond, the speed is unknown."""
    measurements = swinging()
    measurements[:, 2] = np.clip(side * 5.0 * TIME, -RANGE, RANGE * (1 - 1 / 2048))
    found, unusable = estimates(measurements, EstimatorParameters(method))
    clipped = np.abs(5.0 * TIME) > RANGE * (1 - 1 / 2048)
    lost = unusable == LOST
    assert not np.any(lost[~clipped])
    # Lowpass lags; without a model it may wait for the patience of 20 ms.
    assert np.all(lost[np.flatnonzero(clipped)[21:]])
    assert np.array_equal(found[lost, 2], measurements[lost, 2])
    assert np.all(np.isnan(found[lost][:, 3:]))


def test_clipped_arm_speed_is_predicted() -> None:
    """Beyond the tachometer the model gives the speed, also for long."""
    loop = Loop(
        PlantParameters(initial=InitialState(phi_dot=14.0, theta=0.0), seed=2),
        controller=ControllerParameters(mode="off"),
    )
    assert np.all(np.isnan(simulate(loop, 0.01).estimate[:, 1]))  # no start while clipped
    measurements = np.full((600, 5), [0.0, 0.0, 0.0, nan, 1.0])
    # 45 rad/s² per volt, on the linear model at θ = 0 and without friction.
    speed = 45.0 * TIME[:400]
    measurements[:400, 0] = 22.5 * TIME**2
    measurements[:400, 1] = np.minimum(speed, 10.0 * 2047 / 2048)
    p = EstimatorParameters(sensors=SENSORS._replace(encoder_counts=0))
    measurements[:, 2] = 0.0
    found, unusable = estimates(measurements[:300], p)
    assert np.all(unusable >= 0)
    assert found[299, 1] > 11.0


@pytest.mark.parametrize("method", METHODS)
def test_full_turn_sensor_passes_its_seam(method: str) -> None:
    """The jump of 2π at hanging is no motion."""
    sensors = Sensors(potentiometer_range=pi, potentiometer_bits=0, potentiometer_noise=1e-3)
    measurements = swinging()
    angle = 3.0 + 1.0 * TIME
    measurements[:, 2] = (angle + pi) % (2 * pi) - pi
    found, unusable = estimates(measurements, EstimatorParameters(method, sensors=sensors))
    assert np.all(unusable == 0)
    assert np.max(np.abs(np.diff(found[20:, 3]))) < 0.2
    assert np.all(np.abs(np.exp(1j * found[:, 2]) - np.exp(1j * angle)) < 0.1)


def test_a_prediction_that_overflows_replaces_no_reading() -> None:
    """Ideal sensors give speeds at which the nonlinear model overflows: the estimate is lost."""
    measurements = np.random.default_rng(1).normal(size=(50, 5)) * 1e5
    measurements[::5, 0] = inf
    parameters = EstimatorParameters("whole_circle", sensors=Sensors(ideal=True))
    found, unusable = estimates(measurements, parameters)
    assert np.any(unusable[::5] == LOST)
    assert not np.any(np.isinf(found[:, :4]))


def test_a_nonlinear_filter_is_stable_or_refused() -> None:
    """The midpoint rule is stable up to a viscous friction, here 44.4 V s/rad."""
    parameters = EstimatorParameters("whole_circle", model_viscous=44.0)
    parameters.check()
    found, _ = estimates(swinging(), parameters)
    assert np.max(np.abs(found[:, 1])) < 1.0
    beyond = parameters._replace(model_viscous=45.0)
    with pytest.raises(ParameterError, match=r"model_viscous of at most 44\.4 .* given 45"):
        beyond.check()


FALLS = int(os.environ.get("FURUTA_FALLS", "10"))


def fall(method: str, seed: int) -> Record:
    """A pendulum that is let go while the controller is on, hit hard, for 20 s."""
    rng = np.random.default_rng(seed)
    plant = PlantParameters(
        initial=InitialState(
            phi=rng.uniform(-3, 3),
            phi_dot=rng.uniform(-8, 8),
            theta=rng.uniform(-0.6, 0.6),
            theta_dot=rng.choice([-1, 1]) * rng.uniform(8.0, 30.0),
        ),
        seed=seed,
    )
    compensation = ("none", "coulomb", "stiction", "lugre", "adaptive")[seed % 5]
    loop = Loop(plant, EstimatorParameters(method), ObserverParameters(compensation))
    return simulate(loop, 20.0)


@pytest.mark.parametrize("method", METHODS)
def test_a_hanging_pendulum_is_never_driven(method: str) -> None:
    """After any fall the command is 0 V while the pendulum hangs, through all its swings."""
    fell = 0
    for seed in range(FALLS):
        record = fall(method, seed)
        hanging = np.cos(record.state[:, 2]) < 0.0
        fell += bool(np.any(hanging))
        assert not np.any(record.command[hanging])
        assert np.all(np.abs(record.state[:, 0]) < 50.0)
    assert fell >= FALLS // 2


@pytest.mark.parametrize("method", METHODS)
def test_a_pendulum_put_upright_by_hand_is_caught(method: str) -> None:
    """Lifted slowly from hanging and held for 0.1 s, it is balanced again."""
    loop = Loop(PlantParameters(seed=4), EstimatorParameters(method))
    simulation = Simulation(loop)
    simulation.loop = loop._replace(controller=ControllerParameters(enabled=False))
    simulation.run(10.0)
    simulation.loop = loop
    state = simulation.state
    assert cos(state[2]) < 0.0
    for angle in np.linspace(2.0, 0.0, 1000):
        state[:5] = [0.0, 0.0, angle, -2.0, 0.0]
        assert angle < 0.3 or not np.any(simulation.run(1e-3).command)
    for _ in range(100):
        state[:] = 0.0
        simulation.run(1e-3)
    assert np.max(np.abs(simulation.run(10.0).state[:, 2])) < 0.1


@pytest.mark.parametrize("method", METHODS)
def test_skipped_samples_are_bridged(method: str) -> None:
    """With every fifth measurement the speed is as good as with all, not five times too large."""
    measurements, estimator = swinging(), EstimatorSteps(EstimatorParameters(method))
    expected, _ = estimates(measurements, EstimatorParameters(method))
    for k in range(0, 400, 5):
        skipped = skipped_samples(0.005, 0.001) if k else 0
        estimate, unusable = estimator.step(measurements[k], skipped)
        if k >= 100:
            assert estimate[:4] == pytest.approx(expected[k, :4], abs=0.1)
    assert unusable == 0
