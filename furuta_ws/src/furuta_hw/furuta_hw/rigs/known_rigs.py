"""Rigs by name or file."""

from pathlib import Path

from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.rig_file import load_rig
from furuta_model.parameters import ParameterError, suggestion
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

    What has a slash or ends in .yaml or .yml is a path.

    Raises:
        ParameterError: There is no such file or rig.
    """
    path = Path(name)
    if path.exists():
        return path.absolute()
    if "/" in name or path.suffix in (SUFFIX, ".yml"):
        raise ParameterError(f"no rig file {name}")
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
