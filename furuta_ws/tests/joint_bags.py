"""Writes bags of joint states and commands, as a robot records them."""

from pathlib import Path

import numpy as np
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore


def joint_bag(
    path: Path,
    messages: list[tuple[int, int, dict[str, tuple[float, ...]] | float]],
    storage: StoragePlugin = StoragePlugin.SQLITE3,
) -> Path:
    """A bag of messages (arrival, stamp [ns], content): joints with their numbers, or a command."""
    types = get_typestore(Stores.ROS2_JAZZY)
    make = types.types.__getitem__
    with Writer(path, version=9, storage_plugin=storage) as writer:
        kinds = ("sensor_msgs/msg/JointState", "std_msgs/msg/Float64")
        states, command = (
            writer.add_connection(topic, kind, typestore=types)
            for topic, kind in zip(("/joint_states", "/command"), kinds, strict=True)
        )
        for arrival, stamp, content in messages:
            if isinstance(content, float):
                topic, message = command, make(kinds[1])(content)
            else:
                time = make("builtin_interfaces/msg/Time")(*divmod(stamp, 10**9))
                series = [np.array(each) for each in zip(*content.values(), strict=True)]
                series += [np.zeros(0)] * (3 - len(series))
                header = make("std_msgs/msg/Header")(time, "")
                topic, message = states, make(kinds[0])(header, list(content), *series)
            writer.write(topic, arrival, types.serialize_cdr(message, message.__msgtype__))
    return path
