"""Parts of the plant beyond the model: drive, friction, sensors, pushes."""

from typing import Any

import numpy as np
import pytest
import reference
from plant_steps import PlantSteps
from scipy.integrate import solve_ivp

from furuta_control.control import ControllerParameters
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import build
from furuta_model.state import PHI, PHI_DOT, THETA
from furuta_sim.parameters import PlantParameters
from furuta_sim.simulation.closed_loop import Loop, simulate

# Pendulum hanging at rest, so that nothing moves unless it is pushed.
HANGING = {"initial.theta": np.pi}
NO_FRICTION = {"friction.alpha0": 0.0, "friction.alpha1": 0.0}
FINE_DRIVE = {"actuator.bits": 0}
OFF = ControllerParameters(mode="off")


def rig(**given: Any) -> PlantParameters:
    """A rig with some parameters; ``__`` in a name stands for a dot."""
    return build(PlantParameters, {name.replace("__", "."): each for name, each in given.items()})


def run(
    parameters: PlantParameters, commands: np.ndarray, start: np.ndarray | None = None
) -> np.ndarray:
    """The plant's memory after every sample (n,)."""
    plant, rows = PlantSteps(parameters), []
    if start is not None:
        plant.memory["x"][0, : len(start)] = start
    for u in commands:
        plant.move(u)
        rows.append(plant.memory.copy())
    return np.concatenate(rows)


def readings(parameters: PlantParameters, samples: int) -> np.ndarray:
    """Readings (n, 5) while the rig moves freely, with the same noise for any parameters."""
    plant, noise, rows = PlantSteps(parameters), np.random.default_rng(1), []
    for _ in range(samples):
        rows.append(plant.read(noise.standard_normal(2))[0])
        plant.move(0.1)
    return np.array(rows)


def test_drive_delay_and_dead_band() -> None:
    """A voltage acts some samples later, without the dead band; 0 V before."""
    commands = np.array([1.0, -2.0, 0.05, -0.05, 3.0, 0.0, 0.0])
    torque = run(rig(drive__delay=2, drive__dead_band=0.1, **FINE_DRIVE), commands)["drive"][
        "torque"
    ]
    assert torque == pytest.approx([0.0, 0.0, 0.9, -1.9, 0.0, 0.0, 2.9])


def test_drive_lag_is_exact() -> None:
    """The torque approaches the voltage exponentially, and its integral is exact."""
    lag, dt = 0.003, 1e-3
    parameters = rig(drive__lag=lag, **FINE_DRIVE, **NO_FRICTION)
    memory = run(parameters, np.ones(5), np.array([0.0, 0.0, 0.0, 0.0]))
    time = dt * np.arange(1, 6)
    assert memory["drive"]["torque"] == pytest.approx(1.0 - np.exp(-time / lag), rel=1e-12)
    speed = memory["x"][:, PHI_DOT] * (parameters.model.determinant / parameters.model.beta)
    assert speed == pytest.approx(time - lag * (1.0 - np.exp(-time / lag)), rel=2e-3)


def test_pendulum_friction_truly_sticks() -> None:
    """A hanging pendulum stays at an angle whose gravity torque is below its Coulomb level."""
    given = rig(pendulum_friction__coulomb=0.01, friction__law="coulomb")
    delta = given.model.delta
    held, released = 0.9 * 0.01 / delta, 1.1 * 0.01 / delta
    for angle, moves in ((held, False), (released, True)):
        states = run(given, np.zeros(500), np.array([0.3, 0.0, np.pi - angle, 0.0]))
        assert (abs(states["x"][-1, THETA] - (np.pi - angle)) > 1e-6) == moves
        assert states["x"][-1, PHI] == pytest.approx(0.3, abs=1e-12)


def test_pendulum_damping_and_base_motion() -> None:
    """They agree with an independent integration of the equations."""
    given = rig(
        pendulum_friction__damping=0.002,
        pushes__durations=[10.0],
        pushes__base_x=[0.3],
        pushes__base_y=[-0.2],
        sample_time=1e-4,
        **NO_FRICTION,
    )
    body = given.model

    def rate(_: float, x: np.ndarray) -> list[float]:
        phi, v, theta, w = x
        s, c = np.sin(theta), np.cos(theta)
        mass = [[body.alpha + body.beta * s**2, body.gamma * c], [body.gamma * c, body.beta]]
        # Gravity is tilted by -a/g: V = δ (cosθ + ax X + ay Y), with the pendulum's tip at X, Y.
        arm = -body.delta * (0.3 * (-s * np.cos(phi)) - 0.2 * (-s * np.sin(phi)))
        joint = -body.delta * (0.3 * (-c * np.sin(phi)) - 0.2 * (c * np.cos(phi)))
        arm += -2 * body.beta * c * s * v * w + body.gamma * s * w**2
        joint += body.beta * c * s * v**2 + body.delta * s - 0.002 * w
        v_dot, w_dot = np.linalg.solve(mass, [arm, joint])
        return [v, v_dot, w, w_dot]

    start = np.array([0.4, 0.0, 2.0, 0.0])
    expected = solve_ivp(rate, (0, 1.0), start, rtol=1e-10, atol=1e-12).y[:, -1]
    assert run(given, np.zeros(10_000), start)["x"][-1, :4] == pytest.approx(expected, abs=1e-5)


def test_push_is_exact_to_a_sample() -> None:
    """Torque acts in the samples from its begin to its end, and pushes add up."""
    given = rig(
        pushes__times=[0.003, 0.004],
        pushes__durations=[0.002],
        pushes__arm=[1.0, 0.5],
        **NO_FRICTION,
        **HANGING,
    )
    speed = run(given, np.zeros(8))["x"][:, PHI_DOT]
    pushed = np.diff(speed, prepend=0.0) * given.model.determinant / given.model.beta / 1e-3
    assert pushed == pytest.approx([0, 0, 0, 1.0, 1.5, 0.5, 0, 0], abs=0.01)


@pytest.mark.parametrize("law", ["stribeck", "maxwell_slip"])
def test_level_over_angle(law: str) -> None:
    """In a steady slide friction has the level of the law times the factor."""
    friction = Friction(alpha1=0.0, viscous=0.3)
    given = rig(
        friction__law=law,
        friction__variation__angle=0.3,
        friction__variation__angle_periods=3,
        friction__variation__angle_phase=0.5,
        friction__alpha1=0.0,
        friction__viscous=0.3,
        **FINE_DRIVE,
    )
    plant = PlantSteps(given)
    x = plant.memory["x"][0]
    x[THETA] = np.pi
    for _ in range(2000):
        plant.move(0.6)
    factor = 1.0 + 0.3 * np.sin(3 * x[PHI] + 0.5)
    expected = friction.alpha0 * factor + 0.3 * x[PHI_DOT]
    assert x[PHI_DOT] > 0.1
    assert plant.read()[1][-1] == pytest.approx(expected, rel=5e-3)


def test_cogging_has_its_torque() -> None:
    """The arm starts with the acceleration of the cogging torque."""
    given = rig(cogging__torque=0.5, cogging__periods=7, cogging__phase=0.2, **NO_FRICTION)
    start = np.array([0.3, 0.0, np.pi, 0.0])
    states = run(given, np.zeros(1), start)
    expected = reference.accelerations(0.0, np.pi, 0.0, -0.5 * np.sin(2.3), given.model)[0]
    assert states["x"][0, PHI_DOT] / 1e-3 == pytest.approx(expected, rel=1e-2)


def test_late_readings() -> None:
    """A reading shows the state some samples ago, the first state before that."""
    late, sound = (
        readings(rig(sensor_faults__reading_delay=k, sensors__ideal=True), 20) for k in (3, 0)
    )
    assert np.array_equal(late[3:, :4], sound[:-3, :4])
    assert np.array_equal(late[:3, :4], np.tile(sound[0, :4], (3, 1)))


def test_missing_readings_leave_the_others_as_they_are() -> None:
    """NaN at the given rate, for every sensor on its own; all other readings are the same."""
    spoilt, sound = (readings(rig(sensor_faults__missing=p), 20_000)[:, :3] for p in (0.1, 0.0))
    missing = np.isnan(spoilt)
    assert missing.mean(axis=0) == pytest.approx([0.1] * 3, abs=0.01)
    assert missing.all(axis=1).mean() == pytest.approx(1e-3, abs=1e-3)
    assert np.array_equal(spoilt[~missing], sound[~missing])


def test_stuck_and_biased_sensors() -> None:
    """A stuck sensor repeats the reading before; a bias adds to the true value."""
    stuck = readings(rig(sensor_faults__stuck="potentiometer", sensor_faults__stuck_from=0.01), 200)
    sound = readings(rig(), 200)
    assert np.array_equal(stuck[:10], sound[:10], equal_nan=True)
    assert set(stuck[10:, THETA]) == {sound[9, THETA]}
    assert np.array_equal(stuck[:, PHI_DOT], sound[:, PHI_DOT])
    biased = readings(
        rig(
            sensors__ideal=True,
            sensor_faults__arm_bias=0.1,
            sensor_faults__arm_speed_bias=-0.2,
            sensor_faults__pendulum_bias=0.05,
        ),
        20,
    )
    ideal = readings(rig(sensors__ideal=True), 20)
    assert biased - ideal == pytest.approx(np.tile([0.1, -0.2, 0.05, 0.0, 0.0], (20, 1)))


def changing(*phases: tuple[PlantParameters, int]) -> np.ndarray:
    """Readings (n, 4) of one plant, with each of the parameters for so many samples."""
    plant, rows = PlantSteps(phases[0][0]), []
    for parameters, samples in phases:
        plant.design(parameters)
        for _ in range(samples):
            rows.append(plant.read()[0][:4])
            plant.move(0.1)
    return np.array(rows)


IDEAL = rig(sensors__ideal=True)


@pytest.mark.parametrize("bias", [0.0, 1e-9])
def test_a_sensor_sticks_at_its_time_whenever_that_is_set(bias: float) -> None:
    """The time is that of the plant, with other faults before or without."""
    before = rig(sensors__ideal=True, sensor_faults__arm_speed_bias=bias)
    stuck = rig(
        sensors__ideal=True, sensor_faults__stuck="potentiometer", sensor_faults__stuck_from=0.1
    )
    theta = changing((before, 50), (stuck, 100))[:, THETA]
    assert np.all(np.diff(theta[:100]) != 0.0)
    assert np.all(theta[100:] == theta[99])
    late = changing((before, 50), (stuck, 100), (before, 50), (stuck, 20))[:, THETA]
    assert np.all(np.diff(late[149:200]) != 0.0)
    assert np.all(late[201:] == late[200])


def test_late_readings_begin_anew_when_switched_on() -> None:
    """No state from before the delay was switched off; until they come the first one is held."""
    late = rig(sensors__ideal=True, sensor_faults__reading_delay=5)
    seen, true = changing((late, 40), (IDEAL, 60), (late, 40)), changing((IDEAL, 140))
    assert np.array_equal(seen[100:106], np.tile(true[100], (6, 1)))
    assert np.array_equal(seen[105:], true[100:135])


def test_a_speed_from_counts_begins_anew_when_switched_on() -> None:
    """Without a jump from an angle of long ago."""
    fine = {"sensors__encoder_counts": 0, "sensors__tachometer_range": 100.0}
    plain = rig(**fine, **NO_FRICTION)
    counted = rig(sensor_faults__speed_bandwidth=200.0, **fine, **NO_FRICTION)
    seen = changing((counted, 40), (plain, 300), (counted, 40))
    assert np.ptp(seen[:, PHI]) > 0.1
    assert np.max(np.abs(seen[340:, PHI_DOT])) <= np.max(np.abs(np.diff(seen[:, PHI]) / 1e-3))


def test_a_late_drive_begins_anew_when_switched_on() -> None:
    """No voltage from before it was switched off; the lag goes on from the voltage that acted."""
    late = rig(drive__delay=3, **FINE_DRIVE)
    lag = rig(drive__lag=0.01, **FINE_DRIVE)
    plant, torque = PlantSteps(late), []
    for k in range(90):
        if k in (30, 60, 80):
            plant.design({30: rig(**FINE_DRIVE), 60: late, 80: rig(**FINE_DRIVE)}[k])
        plant.move(0.1 * k)
        torque.append(plant.memory["drive"]["torque"][0])
    assert torque[30:60] == [0.1 * k for k in range(30, 60)]
    assert torque[60:80] == [0.1 * k for k in range(57, 77)]
    plant.design(lag)
    plant.move(0.1 * 89)
    assert plant.memory["drive"]["torque"][0] == pytest.approx(8.9)


def test_an_elastic_coupling_that_is_switched_on_starts_relaxed() -> None:
    """The motor is where the arm is, so the arm is not thrown."""
    plant = PlantSteps(rig(**HANGING, **NO_FRICTION))
    x = plant.memory["x"][0]
    for _ in range(200):
        plant.move(0.2)
    before = x.copy()
    assert abs(before[PHI]) > 0.05
    plant.design(rig(coupling__frequency=40.0, **HANGING, **NO_FRICTION))
    for _ in range(20):
        plant.move(0.0)
    assert x[PHI_DOT] == pytest.approx(before[PHI_DOT], rel=0.1)


def test_a_tilt_is_a_constant_acceleration_of_the_base() -> None:
    """The motion is that of a push of the same size that lasts, to the last bit."""
    start = {"initial.theta": 3.0, "initial.phi": 0.7}
    tilted = build(PlantParameters, start | {"tilt.x": 0.03, "tilt.y": -0.02})
    pushed = build(
        PlantParameters,
        start | {"pushes.durations": (1e6,), "pushes.base_x": (0.03,), "pushes.base_y": (-0.02,)},
    )
    commands = np.full(200, 0.5)
    np.testing.assert_array_equal(run(tilted, commands)["x"], run(pushed, commands)["x"])


def test_waves_of_torque_are_cogging() -> None:
    """One wave is cogging of the same size; two waves add up."""
    wave = {"waves.orders": (7.0, 7.0), "waves.cosine": (0.0, 0.0), "waves.sine": (-0.15, -0.05)}
    cogging = {"cogging.torque": 0.2, "cogging.periods": 7, "cogging.phase": 0.0}
    runs = [
        simulate(Loop(build(PlantParameters, {"initial.phi": 0.3} | given), controller=OFF), 0.2)
        for given in (wave, cogging)
    ]
    np.testing.assert_allclose(runs[0].state, runs[1].state, atol=1e-12)
    assert abs(runs[0].state[-1, PHI] - 0.3) > 0.01
