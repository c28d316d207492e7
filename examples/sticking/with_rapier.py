"""Rapier: no dry friction of joints. A stand-in is a motor that brakes with at most the level.

Its joint is one in reduced coordinates (motor), or kept by impulses (impulse). Single precision.
"""

import importlib.metadata
from math import cos, pi, remainder, sin

import rapier3d as rapier

VERSION = importlib.metadata.version("rapier3d")
LAWS = {"": (), "motor": ("coulomb",), "impulse": ("coulomb",)}


def joint(law, p, angle, speed, step, variant):
    """The joint of a scene. The pose of the body gives the angle."""
    world, height = rapier.PhysicsWorld(gravity=(0.0, 0.0, -9.81)), p["height"]
    world.integration_parameters.dt = step
    mass = rapier.MassProperties((0.0, 0.0, height), 1.0, (p["moment"],) * 3)
    body = rapier.RigidBody.dynamic().can_sleep(False).additional_mass_properties(mass)
    along = height * speed * cos(angle), 0.0, -height * speed * sin(angle)
    body = body.rotation((0.0, angle, 0.0)).angvel((0.0, speed, 0.0)).linvel(along)
    ends = world.add_body(rapier.RigidBody.fixed()), world.add_body(body)
    hinge, bodies = rapier.RevoluteJoint((0.0, 1.0, 0.0)), world.rigid_bodies
    hinge.set_motor_model(rapier.MotorModel.FORCE_BASED)
    hinge.set_motor_velocity(0.0, 1e6)
    hinge.set_motor_max_force(p["coulomb"])
    if variant == "impulse":
        world.impulse_joints.insert(*ends, hinge)
    else:  # it begins at 0, and has damping of its own
        tree, _ = world.multibody_joints.get(world.multibody_joints.insert(*ends, hinge))
        root = [0.0] * (tree.ndofs - 1)
        tree.apply_displacements([*root, angle])
        tree.set_generalized_velocity([*root, speed])
        tree.set_damping([*root, 0.0])
        tree.forward_kinematics(bodies)
        tree.update_rigid_bodies(bodies, True)
    link = bodies[ends[1]]

    def move(torque):
        nonlocal angle
        link.reset_torques()
        link.add_torque((0.0, torque - p["viscous"] * link.angvel.y, 0.0))
        world.step()
        angle += remainder(link.rotation.scaled_axis.y - angle, 2.0 * pi)
        return angle, link.angvel.y

    return move
