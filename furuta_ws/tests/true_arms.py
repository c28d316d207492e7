"""Draws arms of two to four links of which all joints move, and what one joint needs for that.

Torques are those of the recursive Newton-Euler equations with accelerations, in frames of the links
(Luh, Walker and Paul 1980). Joints follow their paths exactly, as under a stiff controller.
"""

from math import pi
from pathlib import Path
from typing import NamedTuple

import numpy as np

from furuta_recordings.recording import Recording

DOWN = np.array([0.0, 0.0, -9.81])
MOTIONS = ("s-curves", "fourier", "mixed", "jogs")
RATES = (250.0, 500.0, 1000.0)


class Link(NamedTuple):
    """Frame of its joint in the one before, axis, mass, centre, and inertia about the centre."""

    origin: np.ndarray
    rotation: np.ndarray
    axis: np.ndarray
    mass: float
    centre: np.ndarray
    inertia: np.ndarray


class TrueArm(NamedTuple):
    """Links from the base, and of the chosen joint: drive's inertia, friction and offset.

    ``gravity_friction`` is friction per torque by gravity.
    """

    links: list[Link]
    joint: int
    rotor: float
    alpha0: float
    viscous: float
    asymmetry: float
    offset: float
    gravity_friction: float


class Moved(NamedTuple):
    """A recording of the chosen joint, of the others, and the true values by name."""

    recording: Recording
    others: list[Recording]
    values: dict[str, float]


def rotation_about(axis: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Rotations (n, 3, 3) about an axis (3,), by quaternions."""
    half = 0.5 * np.asarray(angle)
    w, (x, y, z) = np.cos(half), (component * np.sin(half) for component in axis)
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def torque_of(
    links: list[Link], joint: int, q: np.ndarray, v: np.ndarray, a: np.ndarray, down: np.ndarray
) -> np.ndarray:
    """Torque (n,) that moves a joint, for positions and derivatives of all (joints, n)."""
    count = q.shape[1]
    turning, bending = np.zeros((count, 3)), np.zeros((count, 3))
    pulled = np.tile(-down, (count, 1))
    frames, forces, moments = [], [], []
    for link, angle, speed, rate in zip(links, q, v, a, strict=True):
        frame = link.rotation @ rotation_about(link.axis, angle)
        arm = np.broadcast_to(link.origin, turning.shape)
        pulled = pulled + np.cross(bending, arm) + np.cross(turning, np.cross(turning, arm))
        pulled, turning, bending = (
            np.einsum("nji,nj->ni", frame, each) for each in (pulled, turning, bending)
        )
        own = speed[:, None] * link.axis
        bending = bending + rate[:, None] * link.axis + np.cross(turning, own)
        turning = turning + own
        to = np.broadcast_to(link.centre, turning.shape)
        at_centre = pulled + np.cross(bending, to) + np.cross(turning, np.cross(turning, to))
        force = link.mass * at_centre
        moment = bending @ link.inertia + np.cross(turning, turning @ link.inertia)
        frames.append(frame)
        forces.append(force)
        moments.append(moment + np.cross(to, force))
    force, moment = forces[-1], moments[-1]
    for k in range(len(links) - 2, joint - 1, -1):
        force, moment = (np.einsum("nij,nj->ni", frames[k + 1], each) for each in (force, moment))
        moment = (
            moments[k] + moment + np.cross(np.broadcast_to(links[k + 1].origin, force.shape), force)
        )
        force = forces[k] + force
    return np.asarray(moment @ links[joint].axis)


def _random_rotation(r: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Roll, pitch, yaw: often a quarter turn, as in robots; and the rotation."""
    rpy = r.choice([-0.5, 0.0, 0.0, 0.5], 3) * pi
    if r.random() < 0.2:
        rpy = r.uniform(-pi, pi, 3)
    parts = [
        rotation_about(axis, np.array(angle)) for axis, angle in zip(np.eye(3), rpy, strict=True)
    ]
    return rpy, parts[2] @ parts[1] @ parts[0]


def _link(r: np.random.Generator, size: float) -> tuple[Link, np.ndarray]:
    rpy, rotation = _random_rotation(r)
    origin = size * r.choice([0.0, 0.0, 1.0], 3) * r.uniform(-0.5, 0.5, 3)
    origin[r.integers(3)] += size * r.uniform(0.2, 0.5)
    mass = 8.0 * size * r.uniform(0.5, 2.0)
    spread = np.diag((size * r.uniform(0.03, 0.15, 3)) ** 2)
    turn = _random_rotation(r)[1]
    inertia = mass * (np.trace(spread) * np.eye(3) - turn @ spread @ turn.T)
    centre = size * r.uniform(-0.25, 0.25, 3)
    return Link(origin, rotation, np.array([0.0, 0.0, 1.0]), mass, centre, inertia), rpy


def _path(r: np.random.Generator, time: np.ndarray, kind: str) -> np.ndarray:
    """Position, speed and acceleration (3, n) of a joint."""
    if kind == "mixed":
        kind = str(r.choice(["s-curves", "fourier", "jogs"]))
    if kind == "fourier":
        base, q = 2.0 * pi * r.uniform(0.1, 0.2), np.zeros((3, len(time)))
        for k in range(1, 6):
            a, b = r.normal(0.0, 0.7 / k, 2)
            w = k * base
            s, c = np.sin(w * time), np.cos(w * time)
            q += np.array([a * s + b * c, w * (a * c - b * s), -(w**2) * (a * s + b * c)])
        return q
    q, at, begin = np.zeros((3, len(time))), 0.0, r.uniform(0.0, 0.3)
    while begin < time[-1]:
        to = r.uniform(-1.5, 1.5)
        if kind == "jogs":
            to = float(np.clip(at + r.choice([-1, 1]) * r.uniform(0.2, 0.8), -1.5, 1.5))
        lasts = max(abs(to - at) / r.uniform(0.5, 1.5) * 1.9, 0.3)
        s = np.clip((time - begin) / lasts, 0.0, 1.0)
        way = to - at
        q[0] += way * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        q[1] += way * 30.0 * (s * (1.0 - s)) ** 2 / lasts
        q[2] += way * (60.0 * s - 180.0 * s**2 + 120.0 * s**3) / lasts**2
        at, begin = to, begin + lasts + max(r.uniform(-0.3, 0.3), 0.0)
    return q


def moved_arm(seed: int, urdf: Path) -> tuple[TrueArm, str, Moved]:
    """A random arm, how it moves, and its recording; its geometry is written to a file."""
    r = np.random.default_rng(seed)
    count = int(r.integers(2, 5))
    size = float(np.exp(r.uniform(np.log(0.3), np.log(1.2))))
    links, angles = zip(*(_link(r, size) for _ in range(count)), strict=True)
    joint, motion = int(r.integers(count)), MOTIONS[seed % len(MOTIONS)]
    rate = float(r.choice(RATES))
    time = np.arange(0.0, r.uniform(20.0, 40.0), 1.0 / rate)
    paths = np.array([_path(r, time, motion) for _ in range(count)])
    q, v, a = paths.transpose(1, 0, 2)
    load = torque_of(list(links), joint, q, v, a, DOWN)
    still = 0.0 * q
    gravity = torque_of(list(links), joint, q, still, still, DOWN)
    usual = float(np.sqrt(np.mean(load**2)))
    fastest = float(np.sqrt(np.mean(v[joint] ** 2)))
    level = usual * r.uniform(0.1, 0.6)
    arm = TrueArm(
        list(links),
        joint,
        rotor=float(usual / np.sqrt(np.mean(a[joint] ** 2)) * r.choice([0.1, 0.5])),
        alpha0=level,
        viscous=float(level / fastest * r.uniform(0.1, 0.8)),
        asymmetry=float(r.choice([0.0, r.uniform(-0.2, 0.2)])),
        offset=float(0.05 * usual * r.uniform(-1.0, 1.0)),
        gravity_friction=float(r.choice([0.0, r.uniform(0.05, 0.2)])),
    )
    side = np.where(np.abs(v[joint]) > 1e-9, np.sign(v[joint]), 0.0)
    friction = side * (arm.alpha0 + arm.gravity_friction * np.abs(gravity))
    friction += arm.alpha0 * arm.asymmetry * np.abs(side) + arm.viscous * v[joint]
    torque = load + arm.rotor * a[joint] + friction + arm.offset
    torque = torque + 0.01 * usual * r.standard_normal(len(time))
    names = [f"joint{k + 1}" for k in range(count)]
    records = []
    for name, position in zip(names, q, strict=True):
        turn = 2.0 * pi / float(np.exp(r.uniform(np.log(8192.0), np.log(2e5))))
        measured = np.full((len(time), 4), np.nan)
        measured[:, 0] = turn * np.round(position / turn)
        records.append(Recording(name, time, measured, time, 0.0 * torque, joint=name))
    own = records.pop(joint)._replace(command=torque)
    unit = np.zeros((count, len(time)))
    unit[joint] = 1.0
    alone = torque_of(list(links), joint, q, still, unit, 0.0 * DOWN)
    values = {
        "alpha0": arm.alpha0,
        "viscous": arm.viscous,
        "offset": arm.offset + arm.alpha0 * arm.asymmetry,
        "inertia": arm.rotor + float(np.mean(alone)),
        "gravity": float(np.max(np.abs(gravity))),
        "gravity_friction": arm.gravity_friction,
    }
    urdf.write_text(urdf_of(list(links), list(angles)), encoding="utf-8")
    return arm, motion, Moved(own, records, values)


def urdf_of(links: list[Link], angles: list[np.ndarray]) -> str:
    """The arm's geometry."""
    parts = ['<robot name="arm"><link name="link0"/>']
    for k, (link, rpy) in enumerate(zip(links, angles, strict=True), start=1):
        origin = " ".join(map(repr, map(float, link.origin)))
        turned = " ".join(map(repr, map(float, rpy)))
        axis = " ".join(map(repr, map(float, link.axis)))
        parts.append(
            f'<link name="link{k}"/><joint name="joint{k}" type="revolute">'
            f'<parent link="link{k - 1}"/><child link="link{k}"/>'
            f'<origin xyz="{origin}" rpy="{turned}"/><axis xyz="{axis}"/></joint>'
        )
    return "\n".join([*parts, "</robot>"])
