r"""How the links of an arm load one of its joints, with the arm's geometry from a URDF.

The torque of a joint with the axis S, beyond which links have the momentum h and gravity acts with
the wrench w, is (Featherstone 2008)

.. math::
    τ = \frac{d}{dt}(S \cdot h) - (v \times S) \cdot h - S \cdot w

with the velocity v of the joint's own link. All terms are linear in mass, first moments and inertia
of the links, and need no acceleration.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from furuta_model.parameters import ParameterError

# Acceleration [m/s²] of what falls, in the frame of the first link.
GRAVITY = np.array([0.0, 0.0, -9.81])
TURNING, SLIDING, FIXED = ("revolute", "continuous"), ("prismatic",), ("fixed",)


class LinkJoint(NamedTuple):
    """A joint: its frame in that of its parent, which is a number in the list or None, and axis."""

    name: str
    kind: str
    parent: int | None
    origin: np.ndarray
    rotation: np.ndarray
    axis: np.ndarray


class Loads(NamedTuple):
    """What unknown parameters (p,) add to the torque of a joint along a motion of n samples.

    That is the slope of ``momentum`` (n, p), and ``rest``. ``gravity`` is its part of ``rest``,
    ``per_speed`` the momentum per speed of the joint alone.
    """

    momentum: np.ndarray
    rest: np.ndarray
    gravity: np.ndarray
    per_speed: np.ndarray


class _Pose(NamedTuple):
    """A link along a motion: position (n, 3), rotation (n, 3, 3), joint axis, and velocities."""

    position: np.ndarray
    rotation: np.ndarray
    axis: np.ndarray
    turning: np.ndarray
    moving: np.ndarray


def read_linkage(path: str | Path) -> list[LinkJoint]:
    """The joints of a URDF, each after its parent.

    Raises:
        ParameterError: The file is no URDF, or has joints that are not supported.
    """
    try:
        root = ElementTree.parse(path).getroot()
    except OSError as error:
        raise ParameterError(f"{path}: {error.strerror or error}") from error
    except ElementTree.ParseError as error:
        raise ParameterError(f"{path}: no XML: {error}") from error
    elements = root.findall("joint")
    if root.tag != "robot" or not elements:
        raise ParameterError(f"{path}: no URDF: it needs <robot> with joints; expand xacro first")
    parents, children = ([_link(path, e, end) for e in elements] for end in ("parent", "child"))
    joints: list[LinkJoint] = []
    number: dict[str, int | None] = {link: None for link in parents if link not in children}
    waiting = list(range(len(elements)))
    while waiting:
        ready = [k for k in waiting if parents[k] in number]
        if not ready:
            raise ParameterError(f"{path}: its joints form a circle")
        for k in ready:
            joints.append(_joint(path, elements[k], number[parents[k]]))
            number[children[k]] = len(joints) - 1
            waiting.remove(k)
    return joints


def _link(path: str | Path, element: ElementTree.Element, end: str) -> str:
    found = element.find(end)
    if found is None or "link" not in found.attrib:
        raise ParameterError(f"{path}: joint {element.get('name')} has no {end} link")
    return found.attrib["link"]


def _joint(path: str | Path, element: ElementTree.Element, parent: int | None) -> LinkJoint:
    name, kind = element.get("name", ""), element.get("type", "")
    if kind not in (*TURNING, *SLIDING, *FIXED):
        raise ParameterError(
            f"{path}: joint {name} is of the type {kind or '(none)'}; supported are "
            f"{', '.join((*TURNING, *SLIDING, *FIXED))}"
        )
    angles = _numbers(path, element, "origin", "rpy", "0 0 0")
    roll, pitch, yaw = (
        _turned(axis, angle)[0] for axis, angle in zip(np.eye(3), angles[:, None], strict=True)
    )
    axis = _numbers(path, element, "axis", "xyz", "1 0 0")
    if not np.any(axis):
        raise ParameterError(f"{path}: the axis of joint {name} is zero")
    return LinkJoint(
        name,
        kind,
        parent,
        _numbers(path, element, "origin", "xyz", "0 0 0"),
        yaw @ pitch @ roll,
        axis / np.linalg.norm(axis),
    )


def _numbers(
    path: str | Path, element: ElementTree.Element, tag: str, attribute: str, default: str
) -> np.ndarray:
    """Three numbers of an element within a joint."""
    found = element.find(tag)
    text = default if found is None else found.get(attribute, default)
    try:
        values = np.array([float(each) for each in text.split()])
    except ValueError:
        values = np.empty(0)
    if values.shape != (3,) or not np.all(np.isfinite(values)):
        raise ParameterError(
            f"{path}: joint {element.get('name')}: {tag} {attribute} must be three numbers, given "
            f"'{text}'"
        )
    return values


def _turned(axis: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Rotations (n, 3, 3) about a unit axis by angles (n,) (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.asarray(np.eye(3) + s * cross + (1.0 - c) * cross @ cross)


def link_loads(
    joints: Sequence[LinkJoint],
    name: str,
    positions: Mapping[str, np.ndarray],
    speeds: Mapping[str, np.ndarray],
) -> Loads:
    """What ten parameters of each link add to the torque of the joint ``name``.

    They are Ixx, Ixy, Ixz, Iyy, Iyz, Izz about the origin of the link's frame, the first moments
    and the mass, of each moved link from the joint on; a link that is fixed to one is a part of it.
    ``positions`` and ``speeds`` are series (n,) by joint. Joints without one are fixed at 0.
    """
    own = next(k for k, joint in enumerate(joints) if joint.name == name)
    beyond = [
        k for k in range(len(joints)) if joints[k].name in positions and _holds(joints, own, k)
    ]
    poses = _poses(joints, positions, speeds)
    alone = _poses(joints, positions, {name: np.ones_like(speeds[name])})
    here, axis = poses[own], poses[own].axis
    still = np.zeros_like(axis)
    slides = joints[own].kind in SLIDING
    along = (still, axis) if slides else (axis, still)
    across = np.cross(here.turning, axis), np.cross(here.moving, axis)
    turned = (still, across[0]) if slides else across
    momentum = [_dotted(along, here, poses[k]) for k in beyond]
    gravity = [_weight(along, here, poses[k]) for k in beyond]
    turning = [_dotted(turned, here, poses[k]) for k in beyond]
    weights = np.hstack(gravity)
    return Loads(
        np.hstack(momentum),
        weights - np.hstack(turning),
        weights,
        np.hstack([_dotted(along, here, alone[k]) for k in beyond]),
    )


def _holds(joints: Sequence[LinkJoint], own: int, other: int) -> bool:
    """Whether a joint moves another, or itself."""
    at: int | None = other
    while at is not None and at != own:
        at = joints[at].parent
    return at == own


def _poses(
    joints: Sequence[LinkJoint],
    positions: Mapping[str, np.ndarray],
    speeds: Mapping[str, np.ndarray],
) -> list[_Pose]:
    """All links along a motion, in the frame of the first one."""
    none = np.zeros_like(next(iter(positions.values())))
    still = np.zeros((len(none), 3))
    base = _Pose(still, np.tile(np.eye(3), (len(none), 1, 1)), still, still, still)
    poses: list[_Pose] = []
    for joint in joints:
        before = base if joint.parent is None else poses[joint.parent]
        way = positions.get(joint.name, none)
        speed = speeds.get(joint.name, none)[:, None]
        rotation = before.rotation @ joint.rotation
        axis = rotation @ joint.axis
        arm, turning, sliding = before.rotation @ joint.origin, before.turning, 0.0 * axis
        if joint.kind in SLIDING:
            arm, sliding = arm + axis * way[:, None], axis * speed
        elif joint.kind in TURNING:
            rotation, turning = rotation @ _turned(joint.axis, way), turning + axis * speed
        moving = before.moving + np.cross(before.turning, arm) + sliding
        poses.append(_Pose(before.position + arm, rotation, axis, turning, moving))
    return poses


def _in_link(link: _Pose, vector: np.ndarray) -> np.ndarray:
    """Vectors (n, 3) in the frame of a link."""
    return np.einsum("nji,nj->ni", link.rotation, vector)


def _at_link(
    screw: tuple[np.ndarray, np.ndarray], here: _Pose, link: _Pose
) -> tuple[np.ndarray, np.ndarray]:
    """A motion about the origin of a link of what turns and moves so about another."""
    turning, moving = screw
    arm = link.position - here.position
    return _in_link(link, turning), _in_link(link, moving + np.cross(turning, arm))


def _dotted(screw: tuple[np.ndarray, np.ndarray], here: _Pose, link: _Pose) -> np.ndarray:
    """How a link's parameters (n, 10) enter its momentum along a motion about a joint."""
    x, y = _at_link(screw, here, link)
    w, v = _in_link(link, link.turning), _in_link(link, link.moving)
    pairs = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
    inertia = [x[:, i] * w[:, j] + (x[:, j] * w[:, i] if i != j else 0.0) for i, j in pairs]
    first, mass = np.cross(v, x) + np.cross(y, w), np.sum(y * v, axis=1)
    return np.column_stack([*inertia, first, mass])


def _weight(screw: tuple[np.ndarray, np.ndarray], here: _Pose, link: _Pose) -> np.ndarray:
    """How a link's parameters (n, 10) enter the torque that holds it against gravity."""
    x, y = _at_link(screw, here, link)
    down = _in_link(link, np.broadcast_to(GRAVITY, x.shape))
    return np.column_stack([np.zeros((len(x), 6)), np.cross(x, down), -np.sum(y * down, axis=1)])
