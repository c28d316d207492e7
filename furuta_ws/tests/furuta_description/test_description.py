"""The robot description of each rig, and the layouts of display tools."""

import re
import sys
from importlib import import_module
from math import cos, sin
from pathlib import Path

import numpy as np
import pytest
import yaml
from urdf_parser_py.urdf import URDF

from furuta_description.robot_description import display_nodes, robot_description, share
from furuta_hw.rigs.known_rigs import find_rig
from furuta_model.parameters import ParameterError
from furuta_ros.topics import JOINTS, TOPICS


def rotation(axis: list[float], angle: float) -> np.ndarray:
    """Rotation matrix by the formula of Rodrigues."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + sin(angle) * cross + (1 - cos(angle)) * cross @ cross


def test_only_a_view_needs_xacro(monkeypatch: pytest.MonkeyPatch) -> None:
    """The launch file imports this module also where no view is asked for."""
    monkeypatch.setitem(sys.modules, "xacro", None)
    monkeypatch.delitem(sys.modules, "furuta_description.robot_description")
    module = import_module("furuta_description.robot_description")
    with pytest.raises(ModuleNotFoundError, match="the view in RViz needs xacro, which is not"):
        module.display_nodes()


def test_joints_have_the_names_of_the_topics() -> None:
    """A robot state publisher finds the joints of ``joint_states`` by name."""
    robot = URDF.from_xml_string(robot_description(0.3, 0.4))
    assert [joint.name for joint in robot.joints] == list(JOINTS)
    assert {joint.type for joint in robot.joints} == {"continuous"}
    assert robot.get_root() == "base"
    assert all(link.visuals for link in robot.links)


def test_lengths_are_those_of_the_data_sheet() -> None:
    """Qube-Servo 2: arm 85 mm; pendulum as Quanser gives mass, length and inertia."""
    mass, length, inertia = 0.024, 0.0645, 3.33e-5
    model = find_rig("qube_servo_2").model
    assert model.arm_length == pytest.approx(0.085, rel=1e-12)
    expected = (inertia + mass * length**2) / (mass * length)
    assert model.pendulum_length == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("phi", "theta"), [(0.7, 0.2), (-2.0, 3.0)])
def test_pendulum_stands_where_the_equations_have_it(phi: float, theta: float) -> None:
    """θ = 0 is upright; the centre is at (L cosφ − l sinθ sinφ, L sinφ + l sinθ cosφ, l cosθ)."""
    arm_length, length = 0.3, 0.4
    robot = URDF.from_xml_string(robot_description(arm_length, length))
    arm, pendulum = (robot.joint_map[name] for name in JOINTS)
    turned = rotation(arm.axis, phi)
    tip = turned @ (
        np.array(pendulum.origin.xyz) + rotation(pendulum.axis, theta) @ [0.0, 0.0, length]
    )
    expected = [
        arm_length * cos(phi) - length * sin(theta) * sin(phi),
        arm_length * sin(phi) + length * sin(theta) * cos(phi),
        length * cos(theta),
    ]
    assert tip == pytest.approx(expected, abs=1e-9)


def test_display_starts_publisher_and_rviz_in_the_namespace() -> None:
    """RViz gets its layout, the publisher the description of the rig that was named."""
    publisher, rviz = display_nodes("qube_servo_2", "left")
    assert (publisher["package"], publisher["namespace"]) == ("robot_state_publisher", "/left")
    assert 'xyz="0.085 0 0"' in publisher["parameters"][0]["robot_description"]
    layout = yaml.safe_load(Path(rviz["arguments"][1]).read_text())
    shown = {display["Class"]: display for display in layout["Visualization Manager"]["Displays"]}
    model = shown["rviz_default_plugins/RobotModel"]
    assert model["Description Topic"]["Value"] == "robot_description"
    assert layout["Visualization Manager"]["Global Options"]["Fixed Frame"] == "base"
    with pytest.raises(ParameterError, match="no rig other"):
        display_nodes("other")


@pytest.mark.parametrize("file", ["plotjuggler.xml", "foxglove.json"])
def test_layouts_show_the_five_topics(file: str) -> None:
    """And no other one."""
    shown = set(re.findall(r'"/(\w+)[/.]', share("config", file).read_text()))
    assert shown == {topic.name for topic in TOPICS}
