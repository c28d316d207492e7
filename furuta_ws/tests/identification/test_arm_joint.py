"""The friction of a joint of a moving arm; torques come from equations of their own."""

from math import pi
from pathlib import Path

import numpy as np
import pytest
from true_arms import moved_arm

import furuta
from furuta.identification.bodies.arm_joint import identify_arm_joint
from furuta.identification.bodies.linkage import link_loads, read_linkage
from furuta.identification.fitted import Fitted
from furuta_model.parameters import ParameterError
from furuta_recordings.readers import read_axis
from furuta_recordings.recording import Recording

# Both joints turn about an axis across gravity; angles count upward from the horizontal.
URDF = f"""<robot name="two">
<link name="base"/><link name="upper"/><link name="lower"/>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
<origin xyz="0 0 0.3" rpy="{pi / 2} 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/>
<origin xyz="0.4 0 0"/><axis xyz="0 0 1"/></joint></robot>"""
# Mass, centre and inertia about it of both links; gravity; length of the first.
M1, C1, I1, M2, C2, I2, G, L = 3.0, 0.2, 0.05, 2.0, 0.15, 0.03, 9.81, 0.4
# Friction of the shoulder: level, viscous; its offset.
LEVEL, VISCOUS, OFFSET = 2.0, 0.8, 0.7
TIME = np.arange(0.0, 30.0, 0.002)
# Largest error of slopes by differences over this step, of torques up to 33 N m [N m].
TRUNCATED = 5e-4


def angle(*waves: tuple[float, float]) -> np.ndarray:
    """Angle, speed and acceleration (3, n) of a sum of sines: amplitude and frequency [rad/s]."""
    series = [
        np.array((a * np.sin(w * TIME), a * w * np.cos(w * TIME), -a * w * w * np.sin(w * TIME)))
        for a, w in waves
    ]
    return np.sum(series, axis=0)


SHOULDER = angle((0.8, 1.3), (0.3, 4.1))
ELBOW = angle((1.0, 2.2), (0.4, 0.7))


def torques() -> tuple[np.ndarray, np.ndarray]:
    """Torques (n,) of shoulder and elbow by Lagrange's equations of two links in a plane."""
    (q1, v1, a1), (q2, v2, a2) = SHOULDER, ELBOW
    far, cross = I2 + M2 * C2**2, M2 * L * C2
    coupling, weight = cross * np.cos(q2), M2 * C2 * G * np.cos(q1 + q2)
    first = (I1 + M1 * C1**2 + M2 * L**2 + far + 2.0 * coupling) * a1 + (far + coupling) * a2
    first -= cross * np.sin(q2) * (2.0 * v1 * v2 + v2**2)
    first += (M1 * C1 + M2 * L) * G * np.cos(q1) + weight
    return first, (far + coupling) * a1 + far * a2 + cross * np.sin(q2) * v1**2 + weight


def recorded(joint: str, position: np.ndarray, torque: np.ndarray) -> Recording:
    """Positions of an encoder of 65536 counts, and torques."""
    count = 2.0 * pi / 65536
    measured = np.full((len(TIME), 4), np.nan)
    measured[:, 0] = count * np.round(position / count)
    return Recording(joint, TIME, measured, TIME, torque, joint=joint)


def shoulder_and_elbow() -> tuple[Recording, Recording]:
    """A recording of the shoulder with friction, and one of the elbow."""
    speed = SHOULDER[1]
    torque = torques()[0] + LEVEL * np.sign(speed) + VISCOUS * speed + OFFSET
    torque += np.random.default_rng(0).normal(0.0, 0.1, len(TIME))
    return recorded("shoulder", SHOULDER[0], torque), recorded("elbow", ELBOW[0], 0.0 * torque)


@pytest.fixture
def urdf(tmp_path: Path) -> Path:
    """The file of the two links."""
    path = tmp_path / "two.urdf"
    path.write_text(URDF, encoding="utf-8")
    return path


def assert_near(fit: Fitted, true: dict[str, float]) -> None:
    """All values lie within three standard errors of the truth."""
    off = {n: (fit.values[n] - true[n]) / fit.standard_errors[n] for n in true}
    assert all(abs(each) < 3.0 for each in off.values()), off


def test_loads_are_those_of_two_links_in_a_plane(urdf: Path) -> None:
    """Momentum and rest make the torque of Lagrange's equations."""
    joints = read_linkage(urdf)
    series = {"shoulder": SHOULDER, "elbow": ELBOW}
    positions, speeds = ({name: each[k] for name, each in series.items()} for k in (0, 1))
    links = [
        np.array((0, 0, 0, 0, 0, i + m * c**2, m * c, 0, 0, m))
        for m, c, i in ((M1, C1, I1), (M2, C2, I2))
    ]
    for name, torque, beyond in zip(series, torques(), (links, links[1:]), strict=True):
        loads, parameters = link_loads(joints, name, positions, speeds), np.concatenate(beyond)
        slope = np.gradient(loads.momentum @ parameters, TIME, edge_order=2)
        assert slope + loads.rest @ parameters == pytest.approx(torque, abs=TRUNCATED)


def test_loads_are_those_of_a_pole_on_a_cart(tmp_path: Path) -> None:
    """A sliding joint needs a force, and carries a turning one."""
    path = tmp_path / "cart.urdf"
    path.write_text(
        '<robot name="r"><link name="a"/><link name="b"/><link name="c"/>'
        '<joint name="cart" type="prismatic"><parent link="a"/><child link="b"/></joint>'
        '<joint name="pole" type="continuous"><parent link="b"/><child link="c"/>'
        '<axis xyz="0 1 0"/></joint></robot>',
        encoding="utf-8",
    )
    series = {"cart": SHOULDER, "pole": ELBOW}
    positions, speeds = ({name: each[k] for name, each in series.items()} for k in (0, 1))
    cart, pole = np.zeros(10), np.zeros(10)
    cart[9] = M1
    pole[[3, 8, 9]] = I2 + M2 * C2**2, M2 * C2, M2
    (_, _, a), (q, v, b) = SHOULDER, ELBOW
    force = (M1 + M2) * a + M2 * C2 * (b * np.cos(q) - v**2 * np.sin(q))
    torque = (I2 + M2 * C2**2) * b + M2 * C2 * (a * np.cos(q) - G * np.sin(q))
    beyond = {"cart": (force, np.concatenate([cart, pole])), "pole": (torque, pole)}
    for name, (expected, parameters) in beyond.items():
        loads = link_loads(read_linkage(path), name, positions, speeds)
        slope = np.gradient(loads.momentum @ parameters, TIME, edge_order=2)
        assert slope + loads.rest @ parameters == pytest.approx(expected, abs=TRUNCATED)


def test_friction_of_a_joint_while_both_move(urdf: Path) -> None:
    """Friction, offset, mean inertia and gravity are those of the equations."""
    shoulder, elbow = shoulder_and_elbow()
    fit = identify_arm_joint(shoulder, [elbow], urdf)
    inertia = I1 + M1 * C1**2 + M2 * L**2 + I2 + M2 * C2**2
    inertia += 2.0 * M2 * L * C2 * float(np.mean(np.cos(ELBOW[0])))
    weight = (M1 * C1 + M2 * L) * G * np.cos(SHOULDER[0])
    weight += M2 * C2 * G * np.cos(SHOULDER[0] + ELBOW[0])
    own = {"alpha0": LEVEL, "viscous": VISCOUS, "offset": OFFSET, "inertia": inertia}
    assert_near(fit, {**own, "gravity": float(np.max(np.abs(weight)))})
    assert fit.usable == "yes"
    assert fit.standard_errors["alpha0"] < 0.05 * LEVEL
    # A torque of the instant of its row acted half a row before one that holds from there.
    assert fit.values["delay"] < 0.0
    assert set(fit.values) == {*own, "gravity", "delay"}


def test_without_geometry_friction_is_doubtful_and_wider(urdf: Path) -> None:
    """What the links do is approximated; an offset is then not told from gravity."""
    shoulder, elbow = shoulder_and_elbow()
    fit, known = identify_arm_joint(shoulder, [elbow]), identify_arm_joint(shoulder, [elbow], urdf)
    assert_near(fit, {"alpha0": LEVEL})
    assert fit.usable == "doubtful"
    assert fit.standard_errors["alpha0"] > known.standard_errors["alpha0"]
    assert {"offset", "gravity"} <= set(fit.undetermined)


def test_friction_in_proportion_to_the_load_by_gravity(tmp_path: Path) -> None:
    """It is found where the arm has it, from torques by Newton and Euler."""
    arm, _, moved = moved_arm(9, tmp_path / "arm.urdf")
    fit = furuta.identify(moved.recording, furuta.JointBody(moved.others, tmp_path / "arm.urdf"))
    assert arm.gravity_friction > 0.0
    assert_near(
        fit, {name: moved.values[name] for name in ("gravity_friction", "alpha0", "gravity")}
    )


def test_a_table_with_all_joints(tmp_path: Path, urdf: Path) -> None:
    """A joint alone has no command; rows in which another joint has no position do not shift it."""
    shoulder, elbow = shoulder_and_elbow()
    columns = np.column_stack(
        [TIME, shoulder.measured[:, 0], shoulder.command, elbow.measured[:, 0]]
    )
    rows = [",".join(f"{value:.9g}" for value in row) for row in columns]
    rows[:50] = [row.rsplit(",", 1)[0] + "," for row in rows[:50]]
    table = tmp_path / "arm.csv"
    header = "time,shoulder_position [rad],shoulder_effort [N m],q2 [rad]"
    table.write_text("\n".join([header, *rows]), encoding="utf-8")
    other = read_axis(table, "q2", "none", joint="elbow")
    assert not len(other.command)
    assert other.start == pytest.approx(TIME[50])
    fit = identify_arm_joint(read_axis(table, joint="shoulder"), [other], urdf)
    assert_near(fit, {"alpha0": LEVEL, "viscous": VISCOUS, "offset": OFFSET})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("<robot", "<xacro"), "no XML"),
        ((' type="continuous"', ' type="planar"'), "of the type planar"),
        (('"0 0 1"/></joint></robot>', '"0 0 x"/></joint></robot>'), "must be three numbers"),
        (('name="elbow"', 'name="wrist"'), "no moving joint elbow; it has shoulder, wrist"),
        (('<parent link="base"/>', '<parent link="lower"/>'), "form a circle"),
    ],
)
def test_what_is_wrong_with_a_urdf(urdf: Path, change: tuple[str, str], message: str) -> None:
    """One line names it."""
    shoulder, elbow = shoulder_and_elbow()
    urdf.write_text(URDF.replace(*change), encoding="utf-8")
    with pytest.raises(ParameterError, match=message):
        identify_arm_joint(shoulder, [elbow], urdf)


def test_a_joint_is_named_once() -> None:
    """The same joint cannot move beside itself."""
    shoulder, _ = shoulder_and_elbow()
    with pytest.raises(ParameterError, match="named twice"):
        identify_arm_joint(shoulder, [shoulder])
