"""Rapier: a motor that brakes a tilted pendulum on an impulse joint lets it creep.

Weight 0.3 N m, limit of the motor 0.5 N m, inertia 0.1 kg m². Expected 0; found a speed in
proportion to the time step with 1 internal iteration (the default), and none with 10.
"""

import rapier3d as rapier

for iterations in (1, 10):
    for step in (0.005, 0.002, 0.001):
        world = rapier.PhysicsWorld(gravity=(0.0, 0.0, -9.81))
        world.integration_parameters.dt = step
        world.integration_parameters.num_internal_pgs_iterations = iterations
        mass = rapier.MassProperties((0.0306, 0.0, 0.248), 1.0, (0.0376,) * 3)
        body = rapier.RigidBody.dynamic().can_sleep(False).additional_mass_properties(mass)
        ends = world.add_body(rapier.RigidBody.fixed()), world.add_body(body)
        hinge = rapier.RevoluteJoint((0.0, 1.0, 0.0))
        hinge.set_motor_model(rapier.MotorModel.FORCE_BASED)
        hinge.set_motor_velocity(0.0, 1e6)
        hinge.set_motor_max_force(0.5)
        world.impulse_joints.insert(*ends, hinge)
        for _ in range(round(1.0 / step)):
            world.step()
        speed = world.rigid_bodies[ends[1]].angvel.y
        print(f"{iterations} iterations, {step} s: {speed:.6f} rad/s")
