"""PyBullet: friction as URDF has it, or as a motor that brakes with at most its level (motor)."""

import importlib.metadata
import tempfile
from pathlib import Path

import pybullet as bullet

VERSION = importlib.metadata.version("pybullet")
LAWS = {"": ("coulomb",), "motor": ("coulomb",)}
LINK = """<link name="{name}"><inertial><origin xyz="0 0 {height}"/><mass value="1"/>
<inertia ixx="{moment}" iyy="{moment}" izz="{moment}" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
TEXT = """<robot name="scene">{links}<joint name="joint" type="continuous"><parent link="base"/>
<child link="link"/><axis xyz="0 1 0"/><dynamics damping="{viscous}" friction="{coulomb}"/></joint>
</robot>"""


def joint(law, p, angle, speed, step, variant):
    """The joint of a scene."""
    (bullet.resetSimulation if bullet.isConnected() else lambda: bullet.connect(bullet.DIRECT))()
    links = "".join(LINK.format(name=name, **p) for name in ("base", "link"))
    with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
        Path(file.name).write_text(TEXT.format(links=links, **p))
        flags = bullet.URDF_USE_INERTIA_FROM_FILE
        body = bullet.loadURDF(file.name, useFixedBase=True, flags=flags)
    bullet.setGravity(0.0, 0.0, -9.81)
    bullet.setTimeStep(step)
    bullet.changeDynamics(body, 0, linearDamping=0.0, angularDamping=0.0)
    bullet.resetJointState(body, 0, angle, speed)
    # Without this line each joint has a motor that brakes it.
    brake = p["coulomb"] if variant else 0.0
    bullet.setJointMotorControl2(body, 0, bullet.VELOCITY_CONTROL, force=brake)

    def move(torque):
        bullet.setJointMotorControl2(body, 0, bullet.TORQUE_CONTROL, force=torque)
        bullet.stepSimulation()
        return bullet.getJointState(body, 0)[:2]

    return move
