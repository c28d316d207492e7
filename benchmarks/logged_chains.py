"""Draws arms of two to four links and the log of one joint, while all joints follow their paths.

Torques are those of Newton and Euler in the frame of the base, about the axis of the joint. Joints
move by themselves, pause, or move in proportion to each other, as along a line.
"""

from math import pi

import numpy as np
from logged_motions import Logged, log_uniform

MOVES, RATES = ("s-curves", "sines", "in proportion", "jogs"), (125.0, 250.0, 500.0, 1000.0)
DOWN = np.array([0.0, 0.0, -9.81])


def logged_chain(seed: int) -> tuple[Logged, dict[int, Logged], str]:
    """The log of a joint, those of the others by number, and the URDF of the arm.

    ``joint n`` is its first trait.
    """
    r = np.random.default_rng((23, seed))
    count, size = int(r.integers(2, 5)), log_uniform(r, 0.25, 1.2)
    links = [_link(r, size) for _ in range(count)]
    joint, kind = int(r.integers(count)), MOVES[seed % len(MOVES)]
    rate = float(r.choice(RATES))
    time = np.arange(int(r.uniform(15.0, 35.0) * rate)) / rate
    paths = [_path(r, time, kind) for _ in range(count)]
    if kind == "in proportion":
        paths = [r.choice((-1.0, 1.0)) * r.uniform(0.4, 1.0) * paths[0] for _ in range(count)]
    q, v, a = np.array(paths).transpose(1, 0, 2)
    load = joint_torque(links, joint, q, v, a)
    gravity = joint_torque(links, joint, q, 0.0 * v, 0.0 * a)
    unit = np.zeros_like(a)
    unit[joint] = 1.0
    inertia = float(np.mean(joint_torque(links, joint, q, 0.0 * v, unit) - gravity))
    usual, fastest = (float(np.sqrt(np.mean(each**2))) for each in (load, v[joint]))
    rotor = inertia * r.uniform(0.05, 1.0)
    level = (usual + rotor * float(np.std(a[joint]))) * log_uniform(r, 0.1, 0.8)
    viscous, offset = level / fastest * r.uniform(0.1, 0.8), 0.1 * level * r.uniform(-1.0, 1.0)
    under_load = r.uniform(0.05, 0.2) if r.random() < 0.4 else 0.0
    side = np.where(np.abs(v[joint]) > 1e-9, np.sign(v[joint]), 0.0)
    torque = load + rotor * a[joint] + side * (level + under_load * np.abs(gravity))
    torque += viscous * v[joint] + offset
    held = bool(r.random() < 0.5)
    if held:
        torque = 0.5 * (torque + np.append(torque[1:], torque[-1]))
    torque += r.choice((0.002, 0.01, 0.03)) * usual * r.standard_normal(len(time))
    values = {
        "alpha0": level,
        "viscous": float(viscous),
        "offset": float(offset),
        "inertia": inertia + rotor,
        "gravity": float(np.max(np.abs(gravity))),
        "gravity_friction": float(under_load),
        "delay": 0.0 if held else -0.5 / rate,
    }
    logs = {}
    for k in range(count):
        turn = 2.0 * pi / log_uniform(r, 4096.0, 1e6)
        logs[k] = Logged(kind, (), {}, time, turn * np.round(q[k] / turn), 0.0 * time)
    traits = [f"joint {joint}", "torque held" if held else "torque measured"]
    traits += ["friction under load"] if under_load else []
    if values["gravity"] < 1e-9 * usual:
        traits.append("vertical")
        values["gravity"] = 0.0
    own = logs.pop(joint)._replace(traits=tuple(traits), values=values, command=torque)
    return own, logs, _urdf(links)


def _turn(axis: int, angle: np.ndarray | float) -> np.ndarray:
    """Rotations (n, 3, 3) about a coordinate axis."""
    angle = np.atleast_1d(angle)
    found = np.tile(np.eye(3), (len(angle), 1, 1))
    a, b = (axis + 1) % 3, (axis + 2) % 3
    found[:, a, a] = found[:, b, b] = np.cos(angle)
    found[:, b, a], found[:, a, b] = np.sin(angle), -np.sin(angle)
    return found


def _link(r: np.random.Generator, size: float) -> dict[str, np.ndarray]:
    """Place in the frame of the link before, which a roll, pitch and yaw turn; and its mass."""
    rpy = r.choice((-0.5 * pi, 0.0, 0.0, 0.5 * pi), 3)
    origin = size * r.uniform(-0.3, 0.3, 3)
    origin[r.integers(3)] += size * 0.4
    spread, mass = (size * r.uniform(0.05, 0.2, 3)) ** 2, 8.0 * size * r.uniform(0.5, 2.0)
    turned = _turn(0, r.uniform(0, pi))[0] @ _turn(1, r.uniform(0, pi))[0]
    inertia = mass * turned @ np.diag(spread.sum() - spread) @ turned.T
    centre = size * r.uniform(-0.25, 0.25, 3)
    return {"rpy": rpy, "origin": origin, "mass": mass, "centre": centre, "inertia": inertia}


def joint_torque(
    links: list[dict[str, np.ndarray]], joint: int, q: np.ndarray, v: np.ndarray, a: np.ndarray
) -> np.ndarray:
    """Torque (n,) that moves a joint, for positions and derivatives (joints, n) of all."""
    rotation, (turning, bending) = np.eye(3), np.zeros((2, q.shape[1], 3))
    place, pulled = np.zeros((q.shape[1], 3)), np.zeros((q.shape[1], 3))
    total, about, axis = np.zeros((q.shape[1], 3)), place, place
    for k, link in enumerate(links):
        arm = np.broadcast_to(rotation @ link["origin"], place.shape)
        place = place + arm
        pulled = pulled + np.cross(bending, arm) + np.cross(turning, np.cross(turning, arm))
        roll, pitch, yaw = link["rpy"]
        rotation = rotation @ _turn(2, yaw) @ _turn(1, pitch) @ _turn(0, roll) @ _turn(2, q[k])
        z = rotation[:, :, 2]
        bending = bending + a[k][:, None] * z + v[k][:, None] * np.cross(turning, z)
        turning = turning + v[k][:, None] * z
        if k == joint:
            about, axis = place, z
        if k < joint:
            continue
        arm = rotation @ link["centre"]
        at = pulled + np.cross(bending, arm) + np.cross(turning, np.cross(turning, arm))
        inertia = rotation @ link["inertia"] @ np.swapaxes(rotation, 1, 2)
        spin = np.einsum("nij,nj->ni", inertia, turning)
        total = total + np.cross(place + arm - about, link["mass"] * (at - DOWN))
        total = total + np.einsum("nij,nj->ni", inertia, bending) + np.cross(turning, spin)
    return np.asarray(np.sum(total * axis, axis=1))


def _path(r: np.random.Generator, time: np.ndarray, kind: str) -> np.ndarray:
    """Position, speed and acceleration (3, n) of a joint."""
    q = np.zeros((3, len(time)))
    if kind == "sines":
        for k in range(1, 6):
            w, (b, c) = k * 2.0 * pi * r.uniform(0.1, 0.2), r.normal(0.0, 0.7 / k, 2)
            sine, cosine = np.sin(w * time), np.cos(w * time)
            q += [
                b * sine + c * cosine,
                w * (b * cosine - c * sine),
                -w * w * (b * sine + c * cosine),
            ]
        return q
    at, begin = 0.0, r.uniform(0.0, 0.3)
    while begin < time[-1]:
        step = r.choice((-1.0, 1.0)) * r.uniform(0.2, 0.8)
        to = float(np.clip(at + step, -1.5, 1.5)) if kind == "jogs" else r.uniform(-1.5, 1.5)
        lasts = max(1.9 * abs(to - at) / r.uniform(0.5, 1.5), 0.3)
        s = np.clip((time - begin) / lasts, 0.0, 1.0)
        q[0] += (to - at) * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        q[1] += (to - at) * 30.0 * (s * (1.0 - s)) ** 2 / lasts
        q[2] += (to - at) * (60.0 * s - 180.0 * s**2 + 120.0 * s**3) / lasts**2
        at, begin = to, begin + lasts + max(r.uniform(-0.3, 0.3), 0.0)
    return q


def _urdf(links: list[dict[str, np.ndarray]]) -> str:
    """The arm's geometry: masses are not told."""
    parts = ['<robot name="arm"><link name="link0"/>']
    for k, link in enumerate(links):
        xyz, rpy = (" ".join(repr(float(x)) for x in link[name]) for name in ("origin", "rpy"))
        parts.append(
            f'<link name="link{k + 1}"/><joint name="joint{k}" type="revolute">'
            f'<parent link="link{k}"/><child link="link{k + 1}"/>'
            f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="0 0 1"/></joint>'
        )
    return "\n".join([*parts, "</robot>"])
