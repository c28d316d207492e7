"""Rigs by name, and what a rig says of the loop's parameters."""

from __future__ import annotations

from pathlib import Path

from ament_index_python.packages import get_package_share_directory

from furuta_graph.settings import NODES, Settings
from furuta_hw.rig.rig import Rig
from furuta_hw.rig.rig_file import load_rig
from furuta_model.parameters import ParameterError, values

SUFFIX = ".yaml"


def rig_directory() -> Path:
    """Where the rigs that come with the workspace are."""
    return Path(get_package_share_directory("furuta_bringup")) / "config" / "rigs"


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
    """What the rig says of every node: model, friction, sensors, sample time."""
    settings: Settings = {node: {} for node in NODES}
    model, sensors = values(rig.model, "model."), values(rig.sensors, "sensors.")
    time = {"sample_time": rig.line.sample_time}
    settings["plant"] = model | sensors | values(rig.friction, "friction.") | time
    settings["plant"] |= {
        "actuator.voltage_range": rig.drive.range,
        "actuator.bits": rig.drive.bits,
    }
    settings["estimator"] = model | sensors | time
    settings["friction_observer"] = values(rig.friction) | time
    settings["controller"] = model | time | {"voltage_limit": rig.limits.voltage}
    return settings
