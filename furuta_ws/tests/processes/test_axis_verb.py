"""The verb ``axis`` as a user meets it."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from joint_bags import joint_bag

import furuta as library
from furuta.results.table import Table


def test_a_record_identifies_and_says_what_follows(answer: Any, tmp_path: Path) -> None:
    """From a slow motion of a hunting axis; with a controller it counts the draws that hunt."""
    friction = library.Friction(alpha0=0.1, alpha1=0.1, stribeck_velocity=0.1, viscous=0.005)
    time = np.arange(0.0, 8.0, 1e-3)
    moves = 0.5 * np.sin(1.3 * time) + 0.2 * np.sin(3.7 * time)
    recorded = library.simulate_axis(
        library.Axis(0.01, friction), library.Pid(3.0, 2.0, 0.1), reference=moves
    )
    table, joints = tmp_path / "axis.csv", tmp_path / "joints.yaml"
    recorded.write(table)
    found = answer("identify", "--body", "axis", table, "--write", joints)
    result = answer("axis", joints, "--pid", 1, 2, 0.08, "--write", joints)
    assert found["usable"] == "yes"
    assert abs(found["inertia"] - 0.01) < 3.0 * found["standard_errors"]["inertia"] + 1e-5
    assert result["kind"] == "limit_cycle"
    assert result["hunts_in"] == 1.0
    assert result["hunting_rad"][0] < result["peak_to_peak_rad"] < result["hunting_rad"][1]
    written = library.read_joint_file(joints)
    # The best compensation has no integral beside it.
    assert (written.joint, written.controller) == ("axis", library.Pid(1.0, 0.0, 0.08))
    assert written.parameters["compensation"] == result["recommended"]


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A bag of two joints, with different friction, and one that does not move."""
    time = np.arange(0.0, 6.0, 2e-3)
    moves = 0.8 * np.sin(1.3 * time) + 0.4 * np.sin(3.7 * time)
    runs = {
        name: library.simulate_axis(
            library.Axis(0.01, library.Friction(alpha0=level, alpha1=0.0, viscous=0.02)),
            library.Pid(3.0, 2.0, 0.1),
            reference=moves,
            sample_time=2e-3,
        )
        for name, level in (("elbow", 0.1), ("wrist", 0.2))
    }
    messages: list[Any] = []
    for k in range(len(time)):
        at = 10**18 + 2_000_000 * k
        states = {n: (run.measured[k], 0.0, run.torque[k]) for n, run in runs.items()}
        messages.append((at, at, states | {"base": (1.0, 0.0, 0.1)}))
    return joint_bag(tmp_path_factory.mktemp("robot") / "bag", messages)


def test_several_joints_of_a_bag(furuta: Any, robot: Path, tmp_path: Path) -> None:
    """Each is identified on its own; what is not usable is shown, and nothing is written then."""
    saved = tmp_path / "joints.yaml"
    both = ("identify", "--body", "axis", robot, "--joint", "elbow", "--joint", "wrist")
    status, out, err = furuta(*both, "--joint", "base", "--write", saved, "--json")
    assert (status, err.count("\n")) == (1, 1)
    assert "base: bag: the torque is 0.1 throughout" in err
    found = json.loads(out)["joints"]
    assert found["base"]["usable"] == "no"
    assert not saved.exists()
    status, out, err = furuta(*both, "--write", saved)
    assert status == 0, err
    assert re.search(r"^wrist +yes +0\.0", out, re.MULTILINE)
    for name, level in (("elbow", 0.1), ("wrist", 0.2)):
        # The effort acts from its sample on, not until then.
        # Half a sample would be three errors off.
        error = found[name]["standard_errors"]["delay"]
        assert abs(found[name]["delay"] - 0.002) < 2.0 * error
        assert 3.0 * error < 0.001
        assert abs(found[name]["alpha0"] - level) < 4.0 * found[name]["standard_errors"]["alpha0"]
        parameters = library.read_joint_file(saved, name).parameters
        assert parameters["alpha0"] == pytest.approx(found[name]["alpha0"], rel=1e-5)
        assert parameters["sample_time"] == 0.002


def test_a_joint_beside_another_that_moves(
    furuta: Any, answer: Any, robot: Path, tmp_path: Path
) -> None:
    """Its friction is found with the position of the other, with and without geometry."""
    urdf = tmp_path / "robot.urdf"
    urdf.write_text(
        '<robot name="r"><link name="a"/><link name="b"/><link name="c"/>'
        '<joint name="elbow" type="revolute"><parent link="a"/><child link="b"/>'
        '<axis xyz="0 0 1"/></joint><joint name="wrist" type="revolute">'
        '<parent link="b"/><child link="c"/><axis xyz="0 0 1"/></joint></robot>',
        encoding="utf-8",
    )
    options = ("identify", "--body", "joint", robot, "--joint", "elbow", "--moving", "wrist")
    for geometry in ((), ("--urdf", urdf)):
        found = answer(*options, *geometry)
        assert found["units"]["alpha0"] == "N m"
        assert found["residual"]["part"] < 0.05
        assert abs(found["alpha0"] - 0.1) < 3.0 * found["standard_errors"]["alpha0"]
    status, _, err = furuta(*options[:-1], "hand", "--urdf", urdf)
    assert (status, "no joint hand" in err, err.count("\n")) == (1, True, 1)


def test_a_servo_of_which_only_goal_and_position_are_logged(answer: Any, tmp_path: Path) -> None:
    """The loop is a spring of stiffness 1 about the goal, so all is in its units."""
    time = np.arange(0.0, 10.0, 5e-3)
    goal = 0.4 * np.sin(1.7 * time) + 0.2 * np.sign(np.sin(2.9 * time))
    servo = library.Axis(1e-3, library.Friction(alpha0=0.05, viscous=0.05), "coulomb")
    fine = np.repeat(goal, 40)
    loop = library.Pid(1.0, 0.0, 0.0)
    moved = library.simulate_axis(servo, loop, reference=fine, sample_time=1.25e-4)
    table = tmp_path / "servo.csv"
    columns = {"time": time, "goal_deg": np.degrees(goal)}
    position = np.interp(time, moved.time, moved.measured)
    Table(columns | {"position_deg": np.degrees(position)}).write(table)
    found = answer("identify", "--body", "servo", table, "--goal", "goal_deg")
    for name, true in (("inertia", 1e-3), ("friction", 0.05), ("viscous", 0.05)):
        assert abs(found[name] - true) < 4.0 * found["standard_errors"][name] + 0.02 * true, name
    assert found["units"]["friction"] == "rad"
