"""The closed loop, compared with independent results and with the paper."""

import signal
from typing import Any

import control
import numpy as np
import pytest
from scipy.signal import cont2discrete

from furuta.loops import load_rig, make_loop
from furuta.oscillation import measure_oscillation
from furuta.outcomes import SENSORS_SECONDS, outcome, sensors_alone
from furuta_control.estimation import EstimatorParameters
from furuta_control.estimators import kalman
from furuta_friction.compensation import ObserverParameters
from furuta_hw.drivers.serial_protocol.driver import SampleConverter
from furuta_hw.protocol.frames import SensorsFrame
from furuta_model.friction.parameters import Friction
from furuta_model.linear import linearize
from furuta_model.sensors import Actuator
from furuta_sim.parameters import InitialState, PlantFriction, PlantParameters, Sensors
from furuta_sim.simulation import closed_loop
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


def counting_loop(loop: Loop, bandwidth: float) -> float:
    """Swing [rad] of the linear pendulum, whose angles and commands are counted."""
    plant, dt = loop.plant, loop.plant.sample_time
    viscous = plant.friction.parameters.viscous
    a, b = linearize(plant.model, viscous)
    ad, bd, *_ = cont2discrete((a, b[:, None], np.eye(4), 0), dt)
    step = kalman.design(loop.estimator.rig, loop.estimator.kalman).step
    gain = np.array(loop.controller.feedback_gain)
    arm = 2 * np.pi / plant.sensors.encoder_counts
    pendulum = 2 * plant.sensors.potentiometer_range / 2**plant.sensors.potentiometer_bits
    volt = 2 * plant.actuator.voltage_range / 2**plant.actuator.bits
    x, estimate, u, speed, before, series = (
        np.array([0, 0, 0.05, 0]),
        np.zeros(5),
        0.0,
        0.0,
        0.0,
        [],
    )
    for _ in range(round(SENSORS_SECONDS / dt)):
        phi, theta = arm * round(x[0] / arm), pendulum * round(x[2] / pendulum)
        speed += (1 - np.exp(-bandwidth * dt)) * ((phi - before) / dt - speed)
        started = bool(series)
        estimate = (
            step @ [*estimate, u, speed, theta] if started else np.array([phi, 0, theta, 0, 0])
        )
        estimate[0] = np.clip(estimate[0], phi - arm / 2, phi + arm / 2)
        u, before = volt * round(-gain @ estimate[:4] / volt), phi
        x = ad @ x + bd[:, 0] * u
        series.append(x[0])
    return float(np.ptp(series[len(series) // 2 :]))


@pytest.mark.parametrize("poles", [{"omega1": 7.0, "omega2": 5.0}, {"omega1": 7.0, "omega2": 7.0}])
def test_swing_caused_by_the_sensors(poles: dict[str, float]) -> None:
    """It is that of a linear loop with counts, and neither friction nor tilt changes it."""
    given = {**poles, "zeta1": 0.7, "zeta2": 0.7, "friction_process_noise": 0.3}
    rig = load_rig("qube_servo_2")
    found = sensors_alone(make_loop(given, rig=rig))
    disturbed = given | {"alpha0": 0.4, "compensation": "recommended", "tilt.x": 0.1}
    assert sensors_alone(make_loop(disturbed, rig=rig)) == found
    assert found > 0.03
    assert found == pytest.approx(counting_loop(make_loop(given, rig=rig), 200.0), rel=0.3)


def test_ideal_sensors_cause_no_swing() -> None:
    assert sensors_alone(ideal()) < 1e-6


def test_coarse_sensors_let_the_pendulum_fall() -> None:
    coarse = make_loop({"sensors.potentiometer_bits": 4, "sensors.potentiometer_range": 3.2})
    assert sensors_alone(coarse) == np.inf


def test_poles_and_process_noise_of_the_qube() -> None:
    """Its file sets both. They leave little motion without friction and with sticking friction."""
    qube = make_loop({"compensation": "recommended"}, rig="qube_servo_2")
    noise = qube.estimator.kalman
    assert (noise.friction_process_noise, noise.pendulum_process_noise) == (1.0, 0.3)
    assert sensors_alone(qube) < 0.025
    for level in (0.06, 0.2, 0.6):
        friction = {"plant.friction.law": "coulomb", "plant.friction.alpha0": level}
        loop = make_loop({"compensation": "recommended", **friction}, rig="qube_servo_2")
        run = outcome(loop, 30.0)
        assert not run.fell
        assert run.phi_peak_to_peak_rad < 0.03


@pytest.mark.parametrize(
    "settings",
    [
        {"compensation": "lugre", "plant.drive.delay": 3, "plant.drive.lag": 0.01},
        {"compensation": "recommended", "drive.lag": 0.01, "friction.law": "maxwell_slip"},
        {"estimator.method": "lowpass", "sample_time": 0.002},
        {"compensation": lambda memory, x, p: 0.1 * x[1]},
    ],
)
def test_a_run_in_blocks_has_the_same_bits(
    settings: dict[str, object], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also if the last block is short; what shows the progress gets the blocks."""
    loop, given = make_loop(settings), list[range]()
    monkeypatch.setattr(closed_loop, "BLOCK_SECONDS", 100.0)
    whole = Simulation(loop).run(3.0)
    monkeypatch.setattr(closed_loop, "BLOCK_SECONDS", 0.35)
    parts = Simulation(loop).run(3.0, lambda blocks, number: given.append(blocks) or blocks)
    assert len(given[0]) == 9
    for one, other in zip(whole[1:], parts[1:], strict=True):
        assert one.tobytes() == other.tobytes()


def test_an_interrupt_ends_a_run_after_its_block(monkeypatch: pytest.MonkeyPatch) -> None:
    """Python sees Ctrl-C between two calls of compiled code only."""
    blocks = []

    def run(*arguments: Any) -> None:
        blocks.append(len(arguments[-1].command))
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(closed_loop, "_run", run)
    # A process that a shell started in the background ignores it.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            simulate(Loop(), 1000.0)
    finally:
        signal.signal(signal.SIGINT, before)
    assert blocks == [20_000]
