"""The robot description of each rig, and the layouts of display tools."""

import re
import sys
from importlib import import_module
from math import cos, sin
from pathlib import Path

import numpy as np
import pytest
import xacro
import yaml
from scipy.integrate import solve_ivp
from urdf_parser_py.urdf import URDF

from furuta_description.robot_description import display_nodes, robot_description, share
from furuta_hw.rigs.known_rigs import find_rig
from furuta_hw.rigs.rig import Rig
from furuta_model.parameters import ParameterError
from furuta_model.pendulum import accelerations
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
    with pytest.raises(ModuleNotFoundError, match="the robot description needs xacro"):
        module.display_nodes()


def test_joints_have_the_names_of_the_topics() -> None:
    """A robot state publisher finds the joints of ``joint_states`` by name."""
    robot = URDF.from_xml_string(robot_description(Rig(), "left_", joint_prefix=""))
    assert [joint.name for joint in robot.joints] == list(JOINTS)
    assert {joint.type for joint in robot.joints} == {"continuous"}
    assert robot.get_root() == "left_base_link"
    assert all(link.visuals and link.name.startswith("left_") for link in robot.links)


def test_defaults_of_the_file_are_the_papers_rig() -> None:
    """For those who include it in a robot of their own."""
    plain = xacro.process_file(str(share("urdf", "furuta.urdf.xacro"))).documentElement
    assert plain.toprettyxml(indent="  ") in robot_description(Rig())


def test_masses_are_those_of_the_data_sheet() -> None:
    """Qube-Servo 2: a pendulum of 24 g, 64.5 mm to its centre of mass, at most 50 mN m."""
    rig = find_rig("qube_servo_2")
    robot = URDF.from_xml_string(robot_description(rig))
    _, arm, pendulum = robot.links
    assert pendulum.inertial.mass == pytest.approx(0.024, rel=2e-4)
    assert pendulum.inertial.origin.xyz[2] == pytest.approx(0.0645, rel=2e-4)
    assert pendulum.inertial.inertia.ixx == pytest.approx(3.33e-5, rel=1e-3)
    assert robot.joint_map["arm"].limit.effort == pytest.approx(10.0 * 0.042 / 8.4)
    assert arm.inertial.inertia.izz > 0.0


@pytest.mark.parametrize("name", ["paper", "qube_servo_2", "odrive_furuta"])
@pytest.mark.parametrize("start", [(0.0, 0.0, 0.1, 0.0), (0.3, 4.0, 2.5, -2.0), (0, -3, -1.5, 6)])
def test_mujoco_moves_as_the_equations(name: str, start: tuple[float, ...]) -> None:
    """Without friction and torque; the reference is scipy's integration of eq. (1)."""
    mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed")
    rig = find_rig(name)
    loaded = mujoco.MjModel.from_xml_string(robot_description(rig))
    loaded.opt.timestep, loaded.opt.integrator = 1e-3, mujoco.mjtIntegrator.mjINT_RK4
    data = mujoco.MjData(loaded)
    data.qpos[:], data.qvel[:] = start[::2], start[1::2]
    mujoco.mj_step(loaded, data, nstep=2000)

    def motion(_: float, x: np.ndarray) -> tuple[float, ...]:
        arm, pendulum = accelerations(x[1], x[2], x[3], 0.0, rig.model)
        return x[1], arm, x[3], pendulum

    end = solve_ivp(motion, (0.0, 2.0), start, rtol=1e-10, atol=1e-10).y[:, -1]
    assert [*data.qpos, *data.qvel] == pytest.approx([end[0], end[2], end[1], end[3]], abs=1e-5)


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
    model = Rig().model
    arm_length, length = model.arm_length, model.pendulum_length
    robot = URDF.from_xml_string(robot_description(Rig()))
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


def test_two_views_have_nothing_in_common() -> None:
    """Transforms, time, frames and the description are those of their namespace; joints are not."""
    views = [display_nodes("qube_servo_2", name, lockstep=True) for name in ("left", "a/right")]
    for (publisher, rviz), prefix in zip(views, ("left_", "a_right_"), strict=True):
        assert publisher["package"] == "robot_state_publisher"
        robot = URDF.from_xml_string(publisher["parameters"][0]["robot_description"])
        assert {link.name for link in robot.links} == {
            f"{prefix}{name}" for name in ("base_link", *JOINTS)
        }
        assert rviz["arguments"][-2:] == ["-f", robot.get_root()]
        for node in (publisher, rviz):
            assert node["parameters"][0]["use_sim_time"]
            assert dict(node["remappings"]) == {f"/{n}": n for n in ("tf", "tf_static", "clock")}
    assert [view[0]["namespace"] for view in views] == ["/left", "/a/right"]
    with pytest.raises(ParameterError, match="no rig other"):
        display_nodes("other")


def test_layout_of_rviz_shows_the_description() -> None:
    """Its frame is that of a graph without namespace; launch files name another one."""
    *_, rviz = display_nodes()
    layout = yaml.safe_load(Path(rviz["arguments"][1]).read_text())["Visualization Manager"]
    shown = {display["Class"]: display for display in layout["Displays"]}
    model = shown["rviz_default_plugins/RobotModel"]
    assert model["Description Topic"]["Value"] == "robot_description"
    assert layout["Global Options"]["Fixed Frame"] == rviz["arguments"][-1] == "base_link"


@pytest.mark.parametrize("file", ["plotjuggler.xml", "foxglove.json"])
def test_layouts_show_the_five_topics(file: str) -> None:
    """And no other one."""
    shown = set(re.findall(r'"/(\w+)[/.]', share("config", file).read_text()))
    assert shown == {topic.name for topic in TOPICS}
