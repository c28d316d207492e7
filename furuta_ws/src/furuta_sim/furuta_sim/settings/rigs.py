"""Rigs by name or file, and the parameters of every node that a rig determines."""

from pathlib import Path
from typing import Any

from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.rig_file import load_rig, load_uncertain_rig
from furuta_hw.rigs.uncertainty import Uncertainty
from furuta_model.parameters import ParameterError, suggestion, values
from furuta_ros.installed_files import share_directory

SUFFIX = ".yaml"


def config_directory() -> Path:
    """Where the configuration that comes with the workspace is installed."""
    return share_directory("furuta_bringup") / "config"


def rig_directory() -> Path:
    """Where the rigs that come with the workspace are installed."""
    return config_directory() / "rigs"


def rig_file(name: str) -> Path:
    """The file of a rig, by its path or by the name of one that comes with the workspace.

    What has a slash or ends in .yaml or .yml is a path, whether there is a file or not.
    """
    path = Path(name)
    if "/" in name or path.suffix in (SUFFIX, ".yml") or path.exists():
        return path.absolute()
    known = {file.stem: file for file in sorted(rig_directory().glob(f"*{SUFFIX}"))}
    if name not in known:
        raise ParameterError(
            f"no rig {name}; rigs are {', '.join(known)}, or name a file that ends in {SUFFIX}"
            + suggestion(name, known)
        )
    return known[name]


def find_rig(name: str) -> Rig:
    """The rig of that name or file."""
    return load_rig(rig_file(name))


def find_uncertain_rig(name: str) -> tuple[Rig, Uncertainty]:
    """The rig of that name or file, and the uncertainty of its values."""
    return load_uncertain_rig(rig_file(name))


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
