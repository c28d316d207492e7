"""Names of ROS parameters: in parameter files, and those that every ROS node has."""

from collections.abc import Iterator, Mapping
from typing import Any

# What every node has; this project does not declare them.
NAMES = ("use_sim_time", "start_type_description_service")


def is_of_ros(name: str) -> bool:
    """Whether every ROS node has the parameter."""
    return name in NAMES or name.startswith("qos_overrides.")


def by_full_name(parameters: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Full names and values of the parameters in a section of a file, whose names may nest."""
    for name, value in parameters.items():
        if isinstance(value, Mapping):
            yield from by_full_name(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value
