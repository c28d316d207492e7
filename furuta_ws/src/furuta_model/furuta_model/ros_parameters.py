"""Names of the parameters that every ROS node has; this project does not declare them."""

from __future__ import annotations

NAMES = ("use_sim_time", "start_type_description_service")


def is_of_ros(name: str) -> bool:
    """Whether every ROS node has the parameter."""
    return name in NAMES or name.startswith("qos_overrides.")
