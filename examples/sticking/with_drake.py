"""Drake: it has no dry friction of joints. A stand-in is an actuator that brakes (motor)."""

import importlib.metadata

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    PdControllerGains,
    RevoluteJoint,
    SpatialInertia,
    UnitInertia,
)
from pydrake.systems.analysis import Simulator

VERSION = importlib.metadata.version("drake")
LAWS = {"": (), "motor": ("coulomb",)}
GRAVITY = 9.81
BRAKE = 1e6  # N m s/rad: as a constraint, with the level as limit of its torque


class Joint:
    """The joint of a scene."""

    def __init__(self, law, parameters, angle, speed, step, variant):
        height, moment = parameters.get("gravity", 0.0) / GRAVITY, parameters["inertia"]
        inertia = UnitInertia(moment, moment, moment - height**2)
        plant = MultibodyPlant(step)
        body = plant.AddRigidBody("link", SpatialInertia(1.0, [0.0, 0.0, height], inertia))
        joint = plant.AddJoint(
            RevoluteJoint(
                "joint", plant.world_frame(), body.body_frame(), [0.0, 1.0, 0.0],
                parameters.get("viscous", 0.0),
            )
        )  # fmt: skip
        brake = plant.AddJointActuator("brake", joint, parameters["coulomb"])
        brake.set_controller_gains(PdControllerGains(p=0.0, d=BRAKE))
        plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -GRAVITY])
        plant.Finalize()
        self._simulator, self._plant, self._joint = Simulator(plant), plant, joint
        self._context, self._step = self._simulator.get_mutable_context(), step
        plant.get_desired_state_input_port(brake.model_instance()).FixValue(self._context, [0, 0])
        joint.set_angle(self._context, angle)
        joint.set_angular_rate(self._context, speed)
        port = plant.get_applied_generalized_force_input_port()
        self._torque = port.FixValue(self._context, np.zeros(1))
        self._count = 0

    def step(self, torque):
        """Angle and speed after a time step under a torque."""
        self._count += 1
        self._torque.GetMutableData().set_value(np.array([torque]))
        self._simulator.AdvanceTo(self._count * self._step)
        return self._joint.get_angle(self._context), self._joint.get_angular_rate(self._context)
