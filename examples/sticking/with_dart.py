"""DART: a revolute joint with Coulomb friction."""

import dartpy as dart
import numpy as np

VERSION = dart.__version__
LAWS = {"": ("coulomb",)}


def joint(law, p, angle, speed, step, variant):
    """The joint of a scene."""
    skeleton, world = dart.dynamics.Skeleton("scene"), dart.simulation.World("scene")
    hinge, body = skeleton.createRevoluteJointAndBodyNodePair()
    hinge.setAxis([0.0, 1.0, 0.0])
    centre, moment = [0.0, 0.0, p["height"]], np.eye(3) * p["moment"]
    body.setInertia(dart.dynamics.Inertia(1.0, centre, moment))
    hinge.setCoulombFriction(0, p["coulomb"])
    hinge.setDampingCoefficient(0, p["viscous"])
    hinge.setPosition(0, angle)
    hinge.setVelocity(0, speed)
    world.setGravity([0.0, 0.0, -9.81])
    world.setTimeStep(step)
    world.addSkeleton(skeleton)

    def move(torque):
        hinge.setForce(0, torque)
        world.step()
        return hinge.getPosition(0), hinge.getVelocity(0)

    return move
