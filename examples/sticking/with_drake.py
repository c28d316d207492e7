"""Drake: no dry friction of joints. A stand-in is an actuator that brakes (motor)."""

import importlib.metadata
from itertools import count

from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import PdControllerGains, RevoluteJoint, SpatialInertia, UnitInertia
from pydrake.systems.analysis import Simulator

VERSION = importlib.metadata.version("drake")
LAWS = {"": (), "motor": ("coulomb",)}


def joint(law, p, angle, speed, step, variant):
    """The joint of a scene."""
    plant = MultibodyPlant(step)
    about_axis = UnitInertia(p["inertia"], p["inertia"], p["moment"])
    body = plant.AddRigidBody("link", SpatialInertia(1.0, [0.0, 0.0, p["height"]], about_axis))
    frames = plant.world_frame(), body.body_frame()
    hinge = plant.AddJoint(RevoluteJoint("joint", *frames, [0.0, 1.0, 0.0], p["viscous"]))
    brake = plant.AddJointActuator("brake", hinge, p["coulomb"])  # its limit is the level
    brake.set_controller_gains(PdControllerGains(p=0.0, d=1e6))
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -9.81])
    plant.Finalize()
    simulator, steps = Simulator(plant), count(1)
    context = simulator.get_mutable_context()
    plant.get_desired_state_input_port(brake.model_instance()).FixValue(context, [0.0, 0.0])
    applied = plant.get_applied_generalized_force_input_port().FixValue(context, [0.0])
    hinge.set_angle(context, angle)
    hinge.set_angular_rate(context, speed)

    def move(torque):
        applied.GetMutableData().set_value([torque])
        simulator.AdvanceTo(next(steps) * step)
        return hinge.get_angle(context), hinge.get_angular_rate(context)

    return move
