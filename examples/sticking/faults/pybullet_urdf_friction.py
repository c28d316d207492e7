"""PyBullet: the friction of a URDF joint is read, and reported, but has no effect.

Friction 1 N m, torque 0.3 N m, inertia 0.1 kg m². Expected 0; found 6 rad/s after 2 s.
"""

import tempfile
from pathlib import Path

import pybullet as bullet

LINK = """<link name="{}"><inertial><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
TEXT = f"""<robot name="scene">{LINK.format("base")}{LINK.format("link")}
<joint name="joint" type="continuous"><parent link="base"/><child link="link"/><axis xyz="0 0 1"/>
<dynamics damping="0" friction="1"/></joint></robot>"""
bullet.connect(bullet.DIRECT)
file = Path(tempfile.mkdtemp()) / "scene.urdf"
file.write_text(TEXT)
body = bullet.loadURDF(str(file), useFixedBase=True, flags=bullet.URDF_USE_INERTIA_FROM_FILE)
bullet.changeDynamics(body, 0, linearDamping=0.0, angularDamping=0.0)
bullet.setJointMotorControl2(body, 0, bullet.VELOCITY_CONTROL, force=0.0)  # its own brake off
bullet.setTimeStep(0.001)
for _ in range(2000):
    bullet.setJointMotorControl2(body, 0, bullet.TORQUE_CONTROL, force=0.3)
    bullet.stepSimulation()
print("friction", bullet.getJointInfo(body, 0)[7], "N m: speed", bullet.getJointState(body, 0)[1])
