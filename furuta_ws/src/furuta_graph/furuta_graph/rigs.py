"""Rigs by name or file, and the parameters that a rig determines."""

from __future__ import annotations

from pathlib import Path

from ament_index_python.packages import get_package_share_directory

from furuta_graph.settings import Settings, default_settings, parameters_of
from furuta_model.parameters import ParameterError, values
from furuta_rig.rig import Rig
from furuta_rig.rig_file import load_rig

SUFFIX = ".yaml"


def config_directory() -> Path:
    """Where the configuration that comes with the workspace is installed."""
    return Path(get_package_share_directory("furuta_bringup")) / "config"


def rig_directory() -> Path:
    """Where the rigs that come with the workspace are installed."""
    return config_directory() / "rigs"


def rig_file(name: str) -> Path:
    """The file of a rig, by its path or by the name of one that comes with the workspace."""
    path = Path(name)
    if path.suffix == SUFFIX or path.exists():
        return path.absolute()
    known = {each.stem: each for each in sorted(rig_directory().glob(f"*{SUFFIX}"))}
    if name not in known:
        raise ParameterError(
            f"no rig {name}; rigs are {', '.join(known)}, or name a file that ends in {SUFFIX}"
        )
    return known[name]


def find_rig(name: str) -> Rig:
    """The rig of that name or file."""
    return load_rig(rig_file(name))


def rig_settings(rig: Rig) -> Settings:
    """Parameters of every node that the rig determines: model, friction, sensors, sample time."""
    settings = default_settings()
    model, sensors = values(rig.model, "model."), values(rig.sensors, "sensors.")
    time = {"sample_time": rig.line.sample_time}
    settings["plant"] = model | sensors | values(rig.friction, "friction.") | time
    settings["plant"] |= {
        "actuator.voltage_range": rig.drive.range,
        "actuator.bits": rig.drive.bits,
    }
    settings["estimator"] = model | sensors | time
    settings["estimator"] |= {"viscous_friction": rig.friction.viscous}
    settings["friction_observer"] = values(rig.friction) | time
    settings["controller"] = model | time
    settings["controller"] |= {
        "voltage_limit": rig.limits.voltage,
        "arm_angle_limit": rig.limits.arm_angle,
        "arm_speed_limit": rig.limits.arm_speed,
        "swing_up.viscous_friction": rig.friction.viscous,
    }
    return settings


def check_sample_time(rig: Rig | None, settings: Settings) -> None:
    """Raise ParameterError if the rig samples at another time than the nodes expect."""
    of_rig = (rig or Rig()).line.sample_time
    of_nodes = parameters_of(settings)["estimator"].sample_time
    if of_rig != of_nodes:
        raise ParameterError(
            f"the rig's sample_time is {of_rig:g} s, that of the nodes is {of_nodes:g} s"
        )
