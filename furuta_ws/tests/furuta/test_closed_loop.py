"""The closed loop, compared with independent results and with the paper."""

import control
import numpy as np
import pytest
from scipy.signal import cont2discrete

from furuta.loops import load_rig, make_loop
from furuta.oscillation import measure_oscillation
from furuta_control.estimation import EstimatorParameters
from furuta_friction.compensation import ObserverParameters
from furuta_hw.drivers.serial_protocol.driver import SampleConverter
from furuta_hw.protocol.frames import SensorsFrame
from furuta_model.converter import Actuator
from furuta_model.friction.parameters import Friction
from furuta_sim.parameters import InitialState, PlantFriction, PlantParameters, Sensors
from furuta_sim.simulation.closed_loop import Loop, Simulation, simulate

# Two independent codes agree on these: continuous feedback of the exact state.
PHI_SIZE, THETA_SIZE, PERIOD = 0.5106, 0.0918, 2.370


def ideal(dt: float = 1e-3, **plant: object) -> Loop:
    """The loop with ideal sensors and drive."""
    sensors, actuator = Sensors(ideal=True), Actuator(bits=0)
    return Loop(
        PlantParameters(sensors=sensors, actuator=actuator, sample_time=dt, **plant),
        EstimatorParameters(sensors=sensors, sample_time=dt),
        ObserverParameters(sample_time=dt),
    )


@pytest.mark.parametrize(("dt", "tolerance"), [(1e-3, 0.01), (1e-4, 5e-4)])
def test_ideal_limit_cycle(dt: float, tolerance: float) -> None:
    """Peak to peak and period agree with independent results, better with shorter samples."""
    record = simulate(ideal(dt), 60.0)
    found = measure_oscillation(record.state[len(record.state) // 2 :], dt)
    assert found.phi_peak_to_peak_rad == pytest.approx(PHI_SIZE, rel=tolerance)
    assert found.theta_peak_to_peak_rad == pytest.approx(THETA_SIZE, rel=tolerance)
    assert found.period_s == pytest.approx(PERIOD, rel=tolerance)


def test_frictionless_motion_is_the_linear_one() -> None:
    """Near upright without friction the loop follows the sampled linear system."""
    start = np.array([2e-4, 0.0, 1e-4, 0.0])
    loop = ideal(
        friction=PlantFriction(parameters=Friction(alpha0=0.0, alpha1=0.0)),
        initial=InitialState(*start),
    )
    a = np.array([[0, 1, 0, 0], [0, 0, -11, 0], [0, 0, 0, 1], [0, 0, 33.0, 0]])
    b = np.array([[0], [45], [0], [-29.0]])
    transition, drive, *_ = cont2discrete((a, b, np.eye(4), np.zeros((4, 1))), 1e-3)
    gain = control.place(a, b, np.roots([1, 16.8, 142.6, 588, 1225]))
    x, expected = start, []
    for _ in range(1000):
        expected.append(x)
        x = transition @ x - drive @ gain @ x
    state = simulate(loop, 1.0).state
    assert state == pytest.approx(np.array(expected), abs=1e-3 * np.abs(expected).max())


def test_seed_determines_the_run() -> None:
    """The same seed gives the same run to the last bit, another seed a different run."""
    first, again, other = (simulate(Loop(PlantParameters(seed=k)), 2.0) for k in (5, 5, 6))
    for one, two in zip(first[1:], again[1:], strict=True):
        assert np.array_equal(one, two, equal_nan=True)
    assert not np.array_equal(first.state, other.state)


def test_a_run_in_parts_is_the_same_run() -> None:
    """A simulation stopped and continued equals one long run to the last bit."""
    loop = Loop(PlantParameters(seed=5), observer=ObserverParameters("adaptive"))
    simulation = Simulation(loop)
    parts = [simulation.run(seconds) for seconds in (0.5, 0.001, 1.499)]
    whole = simulate(loop, 2.0)
    for k in range(1, 6):
        assert np.array_equal(np.concatenate([part[k] for part in parts]), whole[k])


@pytest.mark.parametrize("name", ["qube_servo_2", "odrive_furuta"])
def test_a_rig_with_encoders_reads_their_counts(name: str) -> None:
    """Its simulated measurements are those that its driver makes of counts, the speed too."""
    rig = load_rig(name)
    record = simulate(make_loop({"omega1": 6.0, "omega2": 9.0}, rig=rig), 1.0)
    converter, arm, pendulum = SampleConverter(rig), rig.arm.channel, rig.pendulum.channel
    codes = [(arm.to_code(x[0]), pendulum.to_code(x[2])) for x in record.state]
    read = [
        converter.convert(SensorsFrame(0, k, 0, 0, 0, a, 0, p, 0)) for k, (a, p) in enumerate(codes)
    ]
    expected = [(sample.arm_angle, sample.arm_speed, sample.pendulum_angle) for sample in read]
    assert record.measurement[:, :3] == pytest.approx(np.array(expected), abs=1e-9)
    assert np.ptp(record.measurement[:, 1]) > 0.1
