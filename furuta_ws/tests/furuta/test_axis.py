"""A servo axis: from a recording to the prediction of its hunting and to a compensation."""

from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
from joint_reference import ReferenceJoint
from random_loops import random_axis
from scipy.integrate import solve_ivp

import furuta
import furuta.limit_cycles.limit_cycle as engine
from furuta.axis.axis import Controller, IntegralRule, servo_motions
from furuta.axis.compensations import compare_on_axis, residual
from furuta.axis.cures import cures
from furuta.axis.friction_text import friction_from_text
from furuta.axis.gains import gain_rows, per_unit, stable_gains
from furuta.axis.joint_file import NEEDED, joint_parameters, write_joint_file
from furuta.axis.quiet_gains import quiet_gains
from furuta.limit_cycles.joint import JointCycle
from furuta.results.rig_friction import MeasuredFriction
from furuta_friction.compensation import COMPENSATIONS
from furuta_ros.parameter_files import read_sections

FRICTION = furuta.Friction(alpha0=0.1, alpha1=0.1, stribeck_velocity=0.1, viscous=0.005)
AXIS = furuta.Axis(0.01, FRICTION)
PID = furuta.Pid(1.0, 2.0, 0.08)
# Parameters of a joint in units of torque.
OF_FORCE = {
    *("alpha0", "alpha1", "sigma0", "sigma1", "axis.inertia", "axis.viscous", "axis.offset"),
    *("axis.friction_process_noise", "axis.largest_correction"),
}


def settled(axis: furuta.Axis, controller: Controller, cycle: JointCycle, **options: str) -> float:
    """Peak to peak [rad] of the simulated error over the last 10 of 20 periods."""
    run = furuta.simulate_axis(axis, controller, seconds=20.0 * cycle.period_s, **options)
    return float(np.ptp(run.error[len(run.error) // 2 :]))


def test_from_a_recording_to_a_compensation(tmp_path: Path) -> None:
    """The hunting of an identified axis is predicted within 5 %, then reduced to a tenth."""
    time = np.arange(0.0, 10.0, 1e-3)
    moves = 1.5 * np.sin(1.3 * time) + 0.6 * np.sin(3.7 * time) * np.sin(0.4 * time)
    recorded = furuta.simulate_axis(AXIS, PID, reference=moves, counts=4096)
    recorded.write(tmp_path / "axis.csv")

    fit = furuta.identify(furuta.read_axis(tmp_path / "axis.csv"), "axis")
    axis = fit.axis()
    cycle = furuta.servo_cycle(axis, PID)
    study = furuta.study_axis(axis, PID)

    assert axis.inertia == pytest.approx(AXIS.inertia, rel=0.02)
    assert axis.friction.alpha0 == pytest.approx(FRICTION.alpha0, rel=0.02)
    assert axis.friction.alpha1 == pytest.approx(FRICTION.alpha1, rel=0.05)
    assert fit.resolution == pytest.approx(2.0 * np.pi / 4096, rel=1e-6)
    path, rule = tmp_path / "joint.yaml", IntegralRule(0.01, True, 0.07)
    write_joint_file(path, {"left/elbow": fit}, PID, study.recommended, rule)
    written = furuta.read_joint_file(path)
    assert written.joint == "left/elbow"
    assert (written.controller, written.rule) == (PID, rule)
    assert written.axis().draws() == fit.draws()
    assert written.parameters["axis.inertia"] == pytest.approx(axis.inertia, rel=1e-5)
    assert f"axis.viscous: {axis.friction.viscous:.6g}  # ± " in path.read_text()
    hunting = settled(AXIS, PID, cycle)
    assert cycle.peak_to_peak == pytest.approx(hunting, rel=0.05)
    assert settled(AXIS, PID, cycle, compensation=study.recommended) < 0.1 * hunting


def test_sampled_hunting_is_the_exact_cycle() -> None:
    """Encoder, observer and sampling change it by less than 5 %, whatever the unit of torque."""
    size = 1e4
    levels = {"alpha0": 0.1 * size, "alpha1": 0.1 * size, "viscous": 0.005 * size}
    axis = furuta.Axis(0.01 * size, FRICTION._replace(**levels))
    pid = furuta.Pid(size, 2.0 * size, 0.08 * size)
    cascade = furuta.Cascade(5.0, 0.1 * size, 0.5 * size)
    for controller in (pid, cascade):
        cycle = furuta.servo_cycle(axis, controller)
        assert cycle.kind == "limit_cycle"
        assert settled(axis, controller, cycle) == pytest.approx(cycle.peak_to_peak, rel=0.05)


def test_both_final_motions_of_a_slow_reference() -> None:
    """From rest the axis sticks and slips; beside that it moves steadily. LSODA gives the same."""
    p = furuta.Friction(1e5, 316.2278, 1.0, 0.5, stribeck_velocity=0.001, viscous=0.4)
    motions = servo_motions(furuta.Axis(1.0, p, "lugre"), furuta.Pid(2.0), 0.1)
    assert {start: motion.kind for start, motion in motions.items()} == {
        "rest": "limit_cycle",
        "steady motion": "steady",
    }

    def rate(_: float, y: np.ndarray) -> list[float]:
        level = p.alpha0 + p.alpha1 * np.exp(-((y[1] / p.stribeck_velocity) ** 2))
        z_dot = y[1] - p.sigma0 * abs(y[1]) / level * y[2]
        force = p.sigma0 * y[2] + p.sigma1 * z_dot + p.viscous * y[1]
        return [0.1 - y[1], 2.0 * y[0] - force, z_dot]

    steps = {"rtol": 1e-9, "atol": [1e-11, 1e-11, 1e-14], "max_step": 0.02}
    run = solve_ivp(rate, (0.0, 30.0), np.zeros(3), "LSODA", **steps)
    slips = run.t[1:][np.diff(np.sign(run.y[1] - 0.05)) > 0.0]
    period = run.t > slips[-1] - motions["rest"].period_s
    assert np.diff(slips)[-1] == pytest.approx(motions["rest"].period_s, abs=0.02)
    assert np.ptp(run.y[0][period]) == pytest.approx(motions["rest"].peak_to_peak, rel=1e-4)
    cycle = furuta.servo_cycle(furuta.Axis(1.0, p, "lugre"), furuta.Pid(2.0), 0.1)
    assert cycle.start == motions["rest"].start


@pytest.mark.parametrize("law", ["stiction", "stribeck"])
def test_size_of_stick_slip_with_a_moving_reference(law: str) -> None:
    """The error is largest where the axis has the speed of the reference, within a slide."""
    p = furuta.Friction(alpha0=0.1, alpha1=0.1, viscous=0.01, stribeck_velocity=0.1)
    cycle = furuta.servo_cycle(furuta.Axis(0.05, p, law), furuta.Pid(1.0, 1.0, 0.05), 0.2)
    _, error, integral = cycle.start

    def rate(_: float, y: np.ndarray) -> list[float]:
        level = p.alpha0 + p.alpha1 * np.exp(-((y[0] / 0.1) ** 2)) * (law == "stribeck")
        force = y[1] + y[2] + 0.05 * (0.2 - y[0]) - level - p.viscous * y[0]
        return [force / 0.05, 0.2 - y[0], y[1]]

    # Stuck: e = e₀ + V t, and the holding force is the breakaway level at its end.
    ends = np.roots([0.1, 0.2 + error, error + integral + 0.01 - 0.2])
    wait = float(ends[ends > 0.0].min())
    start = [0.0, error + 0.2 * wait, integral + error * wait + 0.1 * wait**2]
    fast, stop = (lambda t, y, v=v: y[0] - v for v in (0.2, 0.0))
    stop.terminal, stop.direction = True, -1.0  # type: ignore[attr-defined]
    start = np.add(start, 1e-9 * np.array([1.0, 0.0, 0.0]))
    run = solve_ivp(rate, (0.0, 9.0), start, "DOP853", events=[fast, stop], rtol=1e-12, atol=1e-14)
    errors = [*run.y_events[0][:, 1], error, start[1]]
    assert wait + run.t[-1] == pytest.approx(cycle.period_s, rel=1e-6)
    assert np.ptp(errors) == pytest.approx(cycle.peak_to_peak, rel=1e-7)


@pytest.mark.parametrize("velocity", [1e-2, 1e-4])
def test_steady_motion_near_the_stribeck_velocity(velocity: float) -> None:
    """Its growth rate is that of the slope of the Stribeck curve, however steep that is."""
    p = furuta.Friction(alpha0=1.0, alpha1=0.5, viscous=0.4, stribeck_velocity=velocity)
    speed = 3.5 * velocity
    axis, pd = furuta.Axis(1.0, p, "stribeck"), furuta.Pid(2.0, 0.0, 3.0)
    steady = servo_motions(axis, pd, speed)
    motion = steady.get("steady motion", steady["rest"])
    slope = p.viscous - 7.0 / velocity * p.alpha1 * np.exp(-(3.5**2))
    exact = np.linalg.eigvals([[-3.0 - slope, 2.0], [-1.0, 0.0]]).real.max()
    assert motion.kind == "steady"
    assert motion.growth_rate_1_s == pytest.approx(exact, rel=1e-6)


def test_no_step_passes_over_a_small_stribeck_velocity() -> None:
    """An integration with short steps slides from one end of the cycle to the other."""
    vs = 1e-3
    p = FRICTION._replace(stribeck_velocity=vs)
    end = 0.5 * furuta.servo_cycle(furuta.Axis(0.01, p), PID).peak_to_peak

    def rate(_: float, y: np.ndarray) -> list[float]:
        level = p.alpha0 + p.alpha1 * np.exp(-((y[0] / vs) ** 2)) + p.viscous * y[0]
        return [(y[1] + 2.0 * y[2] - 0.08 * y[0] - level) / 0.01, -y[0], y[1]]

    def stop(_: float, y: np.ndarray) -> float:
        return float(y[0])

    stop.terminal, stop.direction = True, -1.0  # type: ignore[attr-defined]
    after = 1e-3 * vs  # the break-away, from where its series leads
    v = 100.0 * end * after**2
    start = [v, end - v * after / 3, 0.5 * (0.2 - end) + end * after]
    steps = {"max_step": 0.05 * vs, "rtol": 1e-10, "atol": 1e-13 * vs}
    run = solve_ivp(rate, (0.0, 1e3), start, "DOP853", events=stop, **steps)
    assert -run.y[1, -1] == pytest.approx(end, rel=1e-8)


@pytest.mark.parametrize(("law", "hunts"), [("coulomb", False), ("stiction", True)])
def test_static_friction_makes_a_stabilising_pid_hunt(law: str, hunts: bool) -> None:
    """And Coulomb friction alone never does (Bisoffi 2018; Armstrong and Amin 1996)."""
    random = np.random.default_rng(20261124)
    for _ in range(20):
        kind = furuta.servo_cycle(*random_axis(random, law)).kind
        assert (kind in ("limit_cycle", "irregular")) == hunts


@pytest.mark.timeout(60)
def test_a_joint_at_the_limit_of_its_friction_is_at_rest() -> None:
    """On the way to a cycle the engine meets slides of 1e-22 s, on which time does not advance."""
    friction = furuta.Friction(alpha0=0.30068472226519616, alpha1=0.0)
    axis = furuta.Axis(27.860797278697245, friction, "coulomb")
    pid = furuta.Pid(28548.521345677415, 1460698.0487461183, 2229.6578793434733)
    assert furuta.servo_cycle(axis, pid).kind == "rest"


def test_an_irregular_motion_says_what_was_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """If a cycle is not recognised, its size is seen once the transient has passed."""
    loop = furuta.Axis(0.05, FRICTION, "stiction"), furuta.Pid(1.0, 1.0, 0.05), 0.2
    cycle = furuta.servo_cycle(*loop)
    monkeypatch.setattr(engine, "NEARBY", 0.0)
    monkeypatch.setattr(engine, "RETURNS", 20)
    seen = furuta.servo_cycle(*loop)
    assert seen.kind == "irregular"
    assert seen.peak_to_peak == pytest.approx(cycle.peak_to_peak, rel=1e-5)
    assert seen.observed_s == pytest.approx(10.0 * cycle.period_s, rel=1e-5)
    assert seen.transient_s == pytest.approx(10.0 * cycle.period_s, rel=0.2)
    assert seen.transient_s != pytest.approx(seen.observed_s, rel=1e-3)


def test_gains_behind_a_slow_reference() -> None:
    """It sticks and slips; with the gains that are told the exact motion is steady."""
    pd, speed = PID._replace(ki=0.0), 0.2
    gains = quiet_gains(AXIS, pd, speed=speed).controller
    assert isinstance(gains, furuta.Pid)
    assert furuta.servo_cycle(AXIS, pd, speed).kind == "limit_cycle"
    assert furuta.servo_cycle(AXIS, gains, speed).kind == "steady"


@pytest.mark.parametrize("controller", [PID, furuta.Cascade(12.0, 0.08, 0.2)])
def test_without_integral_action_friction_holds_the_axis(controller: Controller) -> None:
    axis = AXIS._replace(law="stiction")
    found = cures(axis, controller, counts=0, sample_time=1e-3, delay=0.0)
    held = next(cure for cure in found if cure.name == "no integral action")
    run = furuta.simulate_axis(axis, held.controller, seconds=20.0, rule=held.rule)
    assert held.error == pytest.approx(1.25 * 0.2 / controller.stiffness)
    assert 0.0 < np.max(np.abs(run.error[-100:])) <= held.error


def test_no_compensation_that_does_not_halve_the_error_is_recommended() -> None:
    """A coarse encoder makes all of them worse than an axis that rests beside its reference."""
    pd = furuta.Pid(4.0, 0.0, 0.2)
    comparison = compare_on_axis(AXIS, pd, counts=40, sample_time=5e-3, largest_chatter=0.025)
    none, best = comparison.residuals[0], comparison.recommended
    assert best == none or best.error_rad <= 0.5 * none.error_rad


def test_gains_in_the_unit_of_a_recording() -> None:
    """1 mm on a screw of 10 mm per turn is 0.628 rad."""
    rows = gain_rows(PID, None, ("rad", "N m"), ("mm", 0.2 * np.pi))
    assert [row["recorded_unit"] for row in rows] == ["N m/mm", "N m/(mm s)", "N m s/mm"]
    assert rows[0]["given_recorded"] == pytest.approx(0.2 * np.pi)
    assert "recorded_unit" not in gain_rows(PID, None, ("m", "N"), ("m", 1.0))[0]
    per_mm = per_unit(PID, 0.2 * np.pi)
    assert per_mm.kp == rows[0]["given_recorded"]
    assert per_unit(per_mm, 5.0 / np.pi) == pytest.approx(PID)


def test_compensations_are_compared_by_the_final_motion() -> None:
    """A heavy axis is released for minutes; where it then rests is that of an integration."""
    friction = furuta.Friction(alpha0=0.1, alpha1=0.05)
    axis, pd = furuta.Axis(10.0, friction, "stiction"), furuta.Pid(4.0, 0.0, 1.0)
    closed = np.array([[-0.1, 0.4], [-1.0, 0.0]])
    exact = ReferenceJoint(closed, np.array([0.1, 0.0]), np.zeros(2), "stiction", friction)
    assert exact.run(np.array([0.0, 0.75]), 1e3, np.zeros(2)).kind == "rest"
    found = residual(axis, axis, pd, "none", counts=0)
    assert found.settled
    assert found.error_rad == pytest.approx(abs(exact.at_rest[1]), rel=0.05)
    assert residual(axis, axis, pd, "stiction").error_rad < 0.2 * found.error_rad


def test_what_does_not_settle_says_so() -> None:
    axis = furuta.Axis(1e4, furuta.Friction(alpha0=1e-3, alpha1=0.0), "coulomb")
    assert not residual(axis, axis, furuta.Pid(1.0, 0.0, 1.0), "none", sample_time=0.02).settled


@pytest.mark.parametrize(
    ("wrong", "given"),
    [
        ("alpha0", -0.1),
        ("alpha1", -0.1),
        ("viscous", -0.1),
        ("sigma0", 0.0),
        ("sigma1", -1.0),
        ("stribeck_velocity", 0.0),
        ("asymmetry", 1.1),
    ],
)
def test_friction_that_cannot_be_is_refused(wrong: str, given: float) -> None:
    """By every function that takes it; the message names the parameter."""
    axis = furuta.Axis(0.01, FRICTION._replace(**{wrong: given}), "lugre")
    one = np.ones(1)
    calls = [
        lambda: furuta.servo_cycle(axis, PID),
        lambda: servo_motions(axis, PID),
        lambda: furuta.simulate_axis(axis, PID, seconds=0.1),
        lambda: furuta.simulate_axis(axis._replace(friction=FRICTION), PID, model=axis),
        lambda: compare_on_axis(axis, PID),
        lambda: furuta.friction_joint((-one[:, None], one, one), axis.friction, axis.law),
        lambda: furuta.friction_law(axis.law, axis.friction),
    ]
    for call in calls:
        with pytest.raises(furuta.ParameterError, match=wrong):
            call()


def test_what_is_recommended_for_a_late_loop_with_gears() -> None:
    """The recommended compensation, which bears a late torque and F̂, without chatter."""
    sampled = {"counts": 2**16, "sample_time": 2e-3}
    of_a_robot = {"delay": 2e-3, "by_topic": True, "largest_chatter": 0.25 * FRICTION.alpha0}
    compared = [
        compare_on_axis(AXIS, PID, **sampled),
        compare_on_axis(AXIS, PID, **sampled, **of_a_robot),
    ]
    at_once, late = ({r.compensation: r for r in each.residuals} for each in compared)
    assert [each.recommended.compensation for each in compared] == ["recommended"] * 2
    assert late["recommended"].error_rad < 1.4 * at_once["recommended"].error_rad
    assert late["recommended"].error_rad < 0.1 * late["none"].error_rad
    assert late["recommended"].chatter_nm < 0.1 * FRICTION.alpha0


def test_joint_file_of_several_joints(tmp_path: Path) -> None:
    """Two joints, of which one has 100 times the torque: only what has the unit of torque grows."""
    time = np.arange(0.0, 6.0, 1e-3)
    moves = 1.5 * np.sin(1.3 * time) + 0.6 * np.sin(3.7 * time)
    recorded = furuta.simulate_axis(AXIS, PID, reference=moves).recording
    fit = furuta.identify(recorded, "axis")
    strong = furuta.identify(recorded._replace(command=100.0 * recorded.command), "axis")
    path = tmp_path / "joints.yaml"
    write_joint_file(path, {"on": fit, "2 b": strong}, PID, "coulomb")
    assert [section.key for section in read_sections(path)][::3] == [
        *("/on/friction_observer", "/_2_b/friction_observer"),
    ]
    write_joint_file(path, {"on": fit, "2 b": strong})
    weak, other = (furuta.read_joint_file(path, name).parameters for name in ("on", "2 b"))
    for name, value in weak.items():
        if isinstance(value, float) and value:
            force = name in OF_FORCE or "gravity" in name
            assert other[name] == pytest.approx(100.0 * value if force else value, rel=1e-3), name
    assert weak["compensation"] == "recommended"
    late = replace(fit, values=fit.values | {"delay": 0.0031})
    given = joint_parameters(late, "on", 1e-3, PID, "coulomb")
    assert (given["compensation"], given["drive.delay"], weak["drive.delay"]) == ("coulomb", 3, 0)


def test_what_is_no_joint_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "joints.yaml"
    joint = "/{0}/friction_observer: {{ros__parameters: {{joint: {0}}}}}\n"
    gains = "/a/controller: {ros__parameters: {pid: [1.0, -2.0, 0.1]}}\n"
    needed = dict.fromkeys(("axis.inerta", *NEEDED), 1.0)
    whole = joint.format("a").replace("{joint", f"{{{str(needed)[1:-1]}, joint")
    for text, name, words in (
        ("", None, "is no joint file"),
        ("/a: {ros__parameters: {joint: a}}", None, "is no joint file"),
        (joint.format("a") + joint.format("b"), None, "several joints, name one"),
        (joint.format("elbow"), "elbo", "no joint elbo; it has elbow"),
        (joint.format("a") + gains, None, "the controller must be pid"),
        (joint.format("a"), None, "joint a has no sample_time, alpha0"),
        (whole, None, "no parameter axis.inerta; did you mean.* axis.inertia"),
    ):
        path.write_text(text)
        with pytest.raises(furuta.ParameterError, match=words):
            furuta.read_joint_file(path, name)


def test_friction_under_load_is_simulated_and_identified() -> None:
    """A gear that loses a tenth of the torque loses it in the recording of a simulation too."""
    time = np.arange(10_000) / 500.0
    moves = 0.8 * np.sin(2.0 * time) + 0.5 * np.sin(5.0 * time + 1.0) + 0.1 * np.sin(17.0 * time)
    friction = friction_from_text("alpha0=0.05,viscous=0.02", "coulomb")
    axis = furuta.Axis(0.01, friction, "coulomb", load_friction=0.1)
    run = furuta.simulate_axis(
        axis, furuta.Pid(20.0, 10.0, 0.8), reference=moves, counts=20_000, sample_time=2e-3
    )
    fit = furuta.identify(run.recording, "axis")
    assert fit.values["load_friction"] == pytest.approx(0.1, abs=0.02)


def test_a_study_speaks_and_draws_what_it_found() -> None:
    """With the unit of each number, on axes that the user has, and with nothing in vain."""
    study = furuta.study_axis(AXIS, PID)
    values, text = study.to_dict(), study.report()
    line = " ".join(text.split())
    assert line.startswith("Pause the integral while the error is below 0.00383 rad")
    assert "the compensation recommended instead of integral action leaves at most" in line
    assert "As it is, the axis hunts by 0.144 rad (8.27°) every 4.43 s" in line
    assert "[N m]" in text
    assert values["units"] == {"position": "rad", "torque": "N m"}
    names = [row["compensation"] for row in values["compensations"]]
    assert names == [*COMPENSATIONS, "recommended"]
    with pytest.raises(furuta.ParameterError, match="identified"):
        study.write("joint.yaml")


def test_unstable_gains_say_which_gain_would_be_stable() -> None:
    """Each alone: by Routh, (kd + viscous) kp must be above ki times the inertia."""
    axis, pid = furuta.Axis(10.0, FRICTION), furuta.Pid(1.0, 2.0, 0.08)
    study = furuta.study_axis(axis, pid)
    assert study.cycle.kind == "unbounded"
    stable = stable_gains(axis, pid)
    assert stable["kp"] == pytest.approx(20.0 / 0.085, rel=0.1)
    assert stable["kd"] == pytest.approx(20.0 - 0.005, rel=0.1)
    assert stable["ki"] == pytest.approx(0.0085, rel=0.1)
    for name, value in stable.items():
        changed = pid._replace(**{name: value})
        assert (changed.kd + FRICTION.viscous) * changed.kp > 10.0 * changed.ki
        assert f"{name} {value:g}" in study.sentence()


def test_measured_friction_of_a_rig_is_drawn() -> None:
    """Its levels by direction, of which the parameters of the law follow."""
    found = MeasuredFriction(0.21, 0.19, 0.25, 0.24, 0.012)
    assert found.to_dict()["alpha0"] == pytest.approx(0.2)
    assert found.to_dict()["units"]["viscous"] == "V s/rad"
    axis = found.plot()
    heights = [line.get_ydata()[0] for line in axis.lines]
    assert {0.21, 0.25, -0.19, -0.24} <= set(heights)
    plt.close(axis.figure)
