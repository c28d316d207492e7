"""Makes the robot description (URDF) of a rig from its lengths."""

from pathlib import Path

import xacro

from furuta_ros.installed_files import share_directory

PACKAGE = "furuta_description"


def share(folder: str, name: str) -> Path:
    """An installed file of this package."""
    return share_directory(PACKAGE) / folder / name


def robot_description(arm_length: float, pendulum_length: float) -> str:
    """The URDF of a pendulum with these lengths [m]."""
    given = {"arm_length": f"{arm_length:.6g}", "pendulum_length": f"{pendulum_length:.6g}"}
    document = xacro.process_file(str(share("urdf", "furuta.urdf.xacro")), mappings=given)
    return str(document.toxml())
