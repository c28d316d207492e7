"""Rigs by name or file, and the parameters that a rig determines."""

from __future__ import annotations

from pathlib import Path

from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.rig_file import load_rig, load_uncertain_rig
from furuta_hw.rigs.uncertainty import Uncertainty
from furuta_model.parameters import ParameterError
from furuta_ros.installed_files import share_directory
from furuta_sim.settings.settings import Settings, parameters_of

SUFFIX = ".yaml"


def config_directory() -> Path:
    """Where the configuration that comes with the workspace is installed."""
    return share_directory("furuta_bringup") / "config"


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


def find_uncertain_rig(name: str) -> tuple[Rig, Uncertainty]:
    """The rig of that name or file, and the uncertainty of its values."""
    return load_uncertain_rig(rig_file(name))


def check_sample_time(rig: Rig | None, settings: Settings) -> None:
    """Raise ParameterError if the rig samples at another time than the nodes expect."""
    of_rig = (rig or Rig()).line.sample_time
    of_nodes = parameters_of(settings)["estimator"].sample_time
    if of_rig != of_nodes:
        raise ParameterError(
            f"the rig's sample_time is {of_rig:g} s, that of the nodes is {of_nodes:g} s"
        )
