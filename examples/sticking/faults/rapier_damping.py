"""Rapier: a joint in reduced coordinates has damping that nobody gave it: 0.1 N m s/rad.

Inertia 0.1 kg m², start at 1 rad/s, no torque. Expected 1 rad/s; found exp(-1) after 1 s.
"""

import rapier3d as rapier

world = rapier.PhysicsWorld()
world.integration_parameters.dt = 0.001
mass = rapier.MassProperties((0.0, 0.0, 0.0), 1.0, (0.1, 0.1, 0.1))
body = rapier.RigidBody.dynamic().can_sleep(False).additional_mass_properties(mass)
ends = world.add_body(rapier.RigidBody.fixed()), world.add_body(body)
hinge = world.multibody_joints.insert(*ends, rapier.RevoluteJoint((0.0, 1.0, 0.0)))
tree, _ = world.multibody_joints.get(hinge)
tree.set_generalized_velocity([0.0] * (tree.ndofs - 1) + [1.0])
for _ in range(1000):
    world.step()
print(
    f"damping {tree.damping()[-1]:.2f} N m s/rad: {world.rigid_bodies[ends[1]].angvel.y:.4f} rad/s"
)
