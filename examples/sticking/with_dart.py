"""DART: a revolute joint with Coulomb friction."""

import dartpy as dart
import numpy as np

VERSION = dart.__version__
LAWS = {"": ("coulomb",)}
GRAVITY = 9.81


class Joint:
    """The joint of a scene."""

    def __init__(self, law, parameters, angle, speed, step, variant):
        height = parameters.get("gravity", 0.0) / GRAVITY
        skeleton = dart.dynamics.Skeleton("joint")
        self._joint, body = skeleton.createRevoluteJointAndBodyNodePair()
        self._joint.setAxis([0.0, 1.0, 0.0])
        moment = np.eye(3) * (parameters["inertia"] - height**2)
        body.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, height], moment))
        self._joint.setCoulombFriction(0, parameters["coulomb"])
        self._joint.setDampingCoefficient(0, parameters.get("viscous", 0.0))
        self._joint.setPosition(0, angle)
        self._joint.setVelocity(0, speed)
        self._world = dart.simulation.World("scene")
        self._world.setGravity([0.0, 0.0, -GRAVITY])
        self._world.setTimeStep(step)
        self._world.addSkeleton(skeleton)

    def step(self, torque):
        """Angle and speed after a time step under a torque."""
        self._joint.setForce(0, torque)
        self._world.step()
        return self._joint.getPosition(0), self._joint.getVelocity(0)
