"""PyBullet: friction as URDF has it, or as a motor that brakes with at most its level (motor)."""

import tempfile
from pathlib import Path

import pybullet as bullet

VERSION = "3.2.7"
LAWS = {"": ("coulomb",), "motor": ("coulomb",)}
GRAVITY = 9.81
TEXT = """<robot name="scene"><link name="base"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><link name="link"><inertial>
<origin xyz="0 0 {height}"/><mass value="1"/>
<inertia ixx="{moment}" iyy="{moment}" izz="{moment}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="joint" type="continuous"><parent link="base"/><child link="link"/><axis xyz="0 1 0"/>
<dynamics damping="{damping}" friction="{friction}"/></joint></robot>"""


class Joint:
    """The joint of a scene."""

    def __init__(self, law, parameters, angle, speed, step, variant):
        height, damping = parameters.get("gravity", 0.0) / GRAVITY, parameters.get("viscous", 0.0)
        moment, friction = parameters["inertia"] - height**2, parameters["coulomb"]
        if bullet.isConnected():
            bullet.resetSimulation()
        else:
            bullet.connect(bullet.DIRECT)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "scene.urdf"
            path.write_text(TEXT.format(**locals()))
            flags = bullet.URDF_USE_INERTIA_FROM_FILE
            self._body = bullet.loadURDF(str(path), useFixedBase=True, flags=flags)
        bullet.setGravity(0.0, 0.0, -GRAVITY)
        bullet.setTimeStep(step)
        bullet.changeDynamics(self._body, -1, linearDamping=0.0, angularDamping=0.0)
        bullet.changeDynamics(self._body, 0, linearDamping=0.0, angularDamping=0.0)
        bullet.resetJointState(self._body, 0, angle, speed)
        # Each joint has a motor that brakes it until its torque is set.
        force = friction if variant == "motor" else 0.0
        bullet.setJointMotorControl2(self._body, 0, bullet.VELOCITY_CONTROL, force=force)

    def step(self, torque):
        """Angle and speed after a time step under a torque."""
        bullet.setJointMotorControl2(self._body, 0, bullet.TORQUE_CONTROL, force=torque)
        bullet.stepSimulation()
        return bullet.getJointState(self._body, 0)[:2]
