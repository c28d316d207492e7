"""``furuta export``, and a rig with the loop on board whose graph is killed."""

import os
import signal
from pathlib import Path
from time import monotonic, sleep
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from processes.conftest import wait_for

from furuta_hw.protocol import frames
from furuta_hw.protocol.frames import encode

PATIENCE = 120.0
# Samples that the pendulum is balanced after the graph has been killed; its watchdog has 50.
ALONE = 5000
# A loaded machine delays processes; the guard would stop the rig before the kill.
RIG = "{line: {watchdog: 0.2}, limits: {command_age: 5, measurement_age: 5, estimate_age: 5}}"
# A joint of a joint file, with characters that XML escapes in its name.
NAME = "left/elbow<&'>"
JOINT = """
/elbow/friction_observer:
  ros__parameters: {joint: "left/elbow<&'>", alpha0: 0.4, alpha1: 0.1, stribeck_velocity: 0.02,
    viscous: 0.01, asymmetry: 0.0, axis.inertia: 0.03, axis.viscous: 0.12, axis.offset: 0.05,
    axis.gravity_sin: 2.0, axis.gravity_cos: -1.0,
    sample_time: 0.002, sigma0: 100.0, sigma1: 1.0}
"""


def test_files(answer: Any, tmp_path: Path) -> None:
    """Names and sizes as printed; the header has parameters, units, and the rig's sources."""
    options = ("--rig", "qube_servo_2", "--set", "compensation=lugre", "--float")
    result = answer("export", "c", *options, "--out", tmp_path / "new")
    files = list(map(Path, result["files"]))
    assert [file.name for file in files] == ["loop.h", "loop.c", "loop_test.c"]
    assert result["bytes"] == sum(file.stat().st_size for file in files)
    header = " ".join(files[0].read_text().split())
    assert "Quanser Qube-Servo 2" in header and "compensation = lugre" in header
    assert "sigma0 = 80.0 V/rad: bristle stiffness" in header
    assert "#define LOOP_REAL float" in header


@pytest.fixture
def joints(tmp_path: Path) -> Path:
    file = tmp_path / "joints.yaml"
    file.write_text(JOINT)
    return file


@pytest.mark.parametrize(
    ("form", "damping", "friction", "centre"),
    [
        ("urdf", "joint/dynamics@damping", "joint/dynamics@friction", "link/inertial/origin@xyz"),
        ("sdf", ".//damping", ".//friction", ".//pose"),
        ("mjcf", ".//joint@damping", ".//joint@frictionloss", ".//inertial@pos"),
    ],
)
def test_joint(
    form: str, damping: str, friction: str, centre: str, furuta: Any, joints: Path
) -> None:
    """Friction, and inertia and gravity about the joint, are those of the joint file."""
    status, out, err = furuta("export", form, "--axis", joints)
    assert status == 0, err
    model = ElementTree.fromstring(out)
    assert NAME in {each.get("name") for each in model.iter("joint")}
    assert (at(model, damping), at(model, friction)) == ([0.13], [0.4])
    mass, moment = {
        "urdf": (".//mass@value", ".//inertia@iyy"),
        "sdf": (".//mass", ".//iyy"),
        "mjcf": (".//inertial@mass", ".//inertial@diaginertia"),
    }[form]
    (kilograms,), about_centre = at(model, mass), at(model, moment)[0]
    x, y, z, *_ = at(model, centre)
    q = 0.7  # rotated about y by q, the centre is at x cos q + z sin q from the joint
    torque = kilograms * 9.81 * (x * np.cos(q) + z * np.sin(q))
    assert y == 0.0 and torque == pytest.approx(-2.0 * np.sin(q) + np.cos(q))
    assert about_centre + kilograms * (x * x + z * z) == pytest.approx(0.03)
    assert "alpha1 0.1" in out and "axis.offset 0.05" in out  # what the formats lack


def at(model: ElementTree.Element, place: str) -> list[float]:
    """The numbers in the text or attribute at a place."""
    path, _, attribute = place.partition("@")
    element = model.find(path)
    assert element is not None, place
    return list(map(float, (element.get(attribute, "") if attribute else element.text).split()))


def test_joint_with_lugre(furuta: Any, joints: Path, tmp_path: Path) -> None:
    """The levels are those of the file, and the step is one in which a bristle is stable."""
    out = tmp_path / "elbow.xml"
    options = ("--lugre", "--step", 2e-3, "--out", out)
    status, _, err = furuta("export", "mjcf", "--axis", joints, *options)
    assert status == 0, err
    model = ElementTree.parse(out).getroot()
    stiffness, damping, coulomb, static, stribeck = at(model, ".//dcmotor@lugre")
    assert (coulomb, static, stribeck) == (0.4, 0.5, 0.02)
    assert at(model, "option@timestep") == [0.002] and damping / stiffness > 0.002
    assert "frictionloss" not in out.read_text()


@pytest.mark.parametrize(
    ("old", "new", "options", "said"),
    [
        ("friction_observer", "plant", (), "joints.yaml is no joint file"),
        ("axis.inertia: 0.03", "axis.inertia: 0", (), "a model needs axis.inertia above 0"),
        ("alpha0: 0.4, ", "", (), "has no alpha0"),
        ("alpha0: 0.4", "alpha0: 0.0", ("--lugre",), "LuGre friction needs"),
        ("", "", ("--prismatic",), "is not prismatic"),
    ],
)
def test_refused_joint(
    old: str, new: str, options: tuple[str, ...], said: str, furuta: Any, joints: Path
) -> None:
    joints.write_text(JOINT.replace(old, new))
    status, out, err = furuta("export", "mjcf", "--axis", joints, *options)
    assert (status, out, err.count("\n")) == (1, "", 1)
    assert said in err


@pytest.mark.long
@pytest.mark.realtime
@pytest.mark.timeout(900)
def test_killed_graph(furuta: Any, processes: Any, emulate: Any, tmp_path: Path) -> None:
    """The rig keeps its balance, still armed; a new session sets 0 V."""
    pytest.importorskip("ziglang", reason="pip install -r firmware/requirements.lock")
    rig_file = tmp_path / "rig.yaml"
    rig_file.write_text(RIG)
    tuned = ("--rig", rig_file, "--set", "compensation=lugre")
    assert furuta("export", "c", *tuned, "--float", "--out", tmp_path / "loop")[0] == 0
    rig = emulate("--loop", tmp_path / "loop", "--rig", rig_file)
    graph = processes.furuta("run", "--plant", "hardware", "--port", rig.port, *tuned)
    end, refusal = monotonic() + PATIENCE, ""
    while not rig.ask("status")["armed"]:
        assert monotonic() < end, refusal
        rig.ask("hold")
        _, _, refusal = processes.run("hw", "arm")
    graph.send_signal(signal.SIGKILL)
    graph.wait()
    until = rig.status["sample"] + ALONE
    wait_for(lambda: rig.status["sample"] >= until)
    status = rig.ask("status")
    assert status["armed"] and abs(status["state"][2]) < 0.2
    line = os.open(rig.port, os.O_RDWR | os.O_NOCTTY)
    os.write(line, b"\0" + encode(frames.HelloFrame(frames.VERSION, 9, 1000, 50)))
    sleep(0.5)
    os.close(line)
    status = rig.ask("status")
    assert (status["armed"], status["volts"]) == (False, 0.0)
