"""The emulated robot of examples/robot_joint: its physics, and its control over topics."""

import json
import signal
import sys
from typing import Any

import numpy as np
import pytest
from sources import ROOT, loaded

FOLDER = ROOT / "examples" / "robot_joint"
H = 1e-4


@pytest.fixture(scope="module")
def robot() -> Any:
    """The module of the robot."""
    return loaded(FOLDER / "robot.py")


def energy(arm: Any, q: np.ndarray, v: np.ndarray) -> float:
    """Kinetic and potential energy [J] of the arm from the motion of its centres of mass."""
    upper, both = q[0], q[0] + q[1]
    elbow = arm.length * np.array([np.cos(upper), np.sin(upper)])
    height = arm.mass[0] * arm.centre[0] * np.sin(upper)
    height += arm.mass[1] * (elbow[1] + arm.centre[1] * np.sin(both))
    across = np.array([-elbow[1], elbow[0]]) * v[0]
    across += arm.centre[1] * np.array([-np.sin(both), np.cos(both)]) * (v[0] + v[1])
    moving = (arm.mass[0] * arm.centre[0] ** 2 + arm.inertia[0]) * v[0] ** 2
    moving += arm.mass[1] * across @ across + arm.inertia[1] * (v[0] + v[1]) ** 2
    moving += np.dot(arm.rotor, v**2)
    return float(0.5 * moving + arm.gravity * height)


def test_energy(robot: Any) -> None:
    """Without friction it stays, with friction it falls until the arm rests."""
    none = (0.0, 0.0)
    free = robot.ARM._replace(coulomb=none, stiction=none, viscous=none, load=none)
    for arm, keeps in ((free, True), (robot.ARM, False)):
        q, v = np.array([0.5, -0.8]), np.array([1.0, -3.0])
        energies = [energy(arm, q, v)]
        for _ in range(400):
            robot.move(q, v, np.zeros(2), H, 100, arm)
            energies.append(energy(arm, q, v))
        if keeps:
            assert energies == pytest.approx(energies[:1] * 401, abs=0.02)
            assert np.abs(v).max() > 0.5
        else:
            assert np.diff(energies).max() < 1e-3
            assert energies[0] - energies[-1] > 5.0
            assert np.all(v == 0.0)


def test_sticks(robot: Any) -> None:
    """A torque below the level of friction moves nothing, not even slowly; one above it does."""
    arm = robot.ARM._replace(gravity=0.0)
    level = arm.coulomb[1] + arm.stiction[1]
    q, v = np.array([0.5, -0.8]), np.zeros(2)
    robot.move(q, v, np.array([0.0, 0.99 * level]), H, 20_000, arm)
    assert q.tolist() == [0.5, -0.8]
    robot.move(q, v, np.array([0.0, 1.05 * level]), H, 2_000, arm)
    assert q[1] > -0.79
    assert q[0] == 0.5  # the shoulder's friction holds it against the reaction


def test_sample(robot: Any) -> None:
    """A torque acts in the next sample, in the drive's steps and limits; brakes hold the arm."""
    arm, none = robot.Robot(), np.zeros(2)
    for _ in range(100):
        position, velocity, effort = arm.sample(none, brakes=True)
    assert position == pytest.approx([0.5, -0.8], abs=robot.COUNT)
    assert [*velocity, *effort] == [0.0] * 4
    arm.sample(np.array([-500.0, 3.333]), brakes=False)
    position, velocity, effort = arm.sample(none, brakes=True)
    assert effort == pytest.approx([-150.0, 3.34], abs=1e-12)
    assert arm.speed[0] < 0.0
    _, _, effort = arm.sample(none, brakes=True)
    assert effort.tolist() == [0.0, 0.0]
    assert arm.speed[0] == 0.0


def test_control_over_topics(processes: Any) -> None:
    """The controller moves the elbow to its reference, and the robot ends by Ctrl-C."""
    robot = processes.start(sys.executable, FOLDER / "robot.py")
    control = processes.start(
        *(sys.executable, FOLDER / "controller.py", "--ros-args"),
        *("-p", "motion:=hold", "-p", "seconds:=3.0"),
    )
    out, err = control.communicate(timeout=60)
    assert control.returncode == 0, err
    assert json.loads(out)["error_max_rad"] < 0.1
    robot.send_signal(signal.SIGINT)
    assert robot.communicate(timeout=60) == ("", "")
    assert robot.returncode == 0
