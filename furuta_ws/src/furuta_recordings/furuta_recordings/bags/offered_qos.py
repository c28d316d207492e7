"""Describes the quality of service that publishers of a topic offer, as rosbag2 Jazzy does."""

from typing import Any

import yaml

# What ROS 2 takes for an unlimited duration.
UNLIMITED = {"sec": 9223372036, "nsec": 854775807}


def offered_qos(
    depth: int, durability: str = "volatile", lifespan: dict[str, int] = UNLIMITED
) -> str:
    """YAML of the profiles of a reliable topic, as a channel of an MCAP file holds it.

    ``depth`` is the length of the queue [messages], ``lifespan`` how long a message is kept
    ({sec, nsec}).
    """
    profile: dict[str, Any] = {
        "history": "keep_last",
        "depth": depth,
        "reliability": "reliable",
        "durability": durability,
        "deadline": UNLIMITED,
        "lifespan": lifespan,
        "liveliness": "automatic",
        "liveliness_lease_duration": UNLIMITED,
        "avoid_ros_namespace_conventions": False,
    }
    return str(yaml.dump([profile], Dumper=_WithoutAliases, sort_keys=False)).strip()


class _WithoutAliases(yaml.SafeDumper):
    """Writes equal values out, as rosbag2 does."""

    def ignore_aliases(self, data: Any) -> bool:
        """Whether to write ``data`` out each time."""
        return True
