"""The parameters of every node that a rig determines."""

from typing import Any

from furuta_hw.rigs.rig import Rig
from furuta_model.parameters import values


def rig_parameters(rig: Rig) -> dict[str, dict[str, Any]]:
    """Model, friction, sensors, sample time and limits, by node and full parameter name.

    Viscous friction, which contains back-EMF, is part of the model of estimator and pole placement.
    The friction observer therefore compensates the rest of the friction.
    """
    model, sensors = values(rig.model, "model."), values(rig.sensors, "sensors.")
    nominal = model | {"model_viscous": rig.friction.viscous}
    time = {"sample_time": rig.line.sample_time}
    return {
        "plant": model | sensors | values(rig.friction, "friction.") | time | _plant_parts(rig),
        "estimator": nominal | sensors | time,
        "friction_observer": values(rig.friction._replace(viscous=0.0)) | time,
        "controller": nominal | time | values(rig.poles) | _limits(rig),
    }


def _plant_parts(rig: Rig) -> dict[str, Any]:
    """What else acts on the simulated plant."""
    return {
        "actuator.voltage_range": rig.drive.range,
        "actuator.bits": rig.drive.bits,
        **values(rig.drive_dynamics, "drive."),
        **values(rig.coupling, "coupling."),
        **values(rig.pendulum_friction, "pendulum_friction."),
        **values(rig.waves, "waves."),
        **values(rig.tilt, "tilt."),
    }


def _limits(rig: Rig) -> dict[str, Any]:
    return {
        "voltage_limit": rig.limits.voltage,
        "arm_angle_limit": rig.limits.arm_angle,
        "arm_speed_limit": rig.limits.arm_speed,
    }
