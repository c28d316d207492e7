"""Makes the robot description (URDF) of a rig from its lengths."""

from pathlib import Path

import xacro

from furuta_description.lengths import Lengths
from furuta_ros.installed_files import share_directory

PACKAGE = "furuta_description"


def share(folder: str, name: str) -> Path:
    """An installed file of this package."""
    return share_directory(PACKAGE) / folder / name


def robot_description(of: Lengths) -> str:
    """The URDF of a pendulum with these lengths."""
    given = {"arm_length": f"{of.arm:.6g}", "pendulum_length": f"{of.pendulum:.6g}"}
    document = xacro.process_file(str(share("urdf", "furuta.urdf.xacro")), mappings=given)
    return str(document.toxml())
