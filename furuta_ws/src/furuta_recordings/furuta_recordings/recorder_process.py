"""Runs the node ``recorder`` in a process of its own, as the launch file starts it.

ros2 run furuta_recordings recorder --ros-args -p directory:=output/bag
"""

import sys
from pathlib import Path
from time import sleep
from typing import Annotated, NamedTuple

from furuta_model.parameters import About, ParameterError
from furuta_recordings.recorder_node import COLLECT_EVERY, RecorderNode
from furuta_ros.errors import UserError, first_line
from furuta_ros.node import FurutaNode
from furuta_ros.process import StopSignal, bounded_end
from furuta_ros.spinning import fail, ros_context


class RecorderParameters(NamedTuple):
    """Parameters of the recorder; they can be set only at its start."""

    directory: Annotated[str, About("directory of the bag; must not exist", read_only=True)] = ""
    stamped: Annotated[
        bool, About("lock-step: use the newest stamp before a message as its time", read_only=True)
    ] = False
    graph_parameters: Annotated[
        str, About("text of a ROS parameter file to keep with the bag", read_only=True)
    ] = ""


def record(arguments: list[str] | None = None) -> int:
    """Record all topics of the graph until SIGINT or SIGTERM; returns the exit status."""
    stop = StopSignal()
    try:
        with ros_context(arguments):
            recorder = _recorder()
            recorder.get_logger().info("ready")
            while not stop() and recorder.failure is None:
                recorder.collect()
                sleep(COLLECT_EVERY)
            recorder.close()
            with bounded_end(int(recorder.failure is not None)):
                recorder.destroy_node()
    except (ParameterError, UserError) as error:
        return fail(first_line(error))
    return int(recorder.failure is not None)


def _recorder() -> RecorderNode:
    """The recorder with the ROS parameters of this process.

    A node of the same name reads them first, because the recorder needs them to be made.
    """
    reader = FurutaNode("recorder", RecorderParameters)
    given = reader.parameters
    reader.destroy_node()
    if not given.directory:
        raise ParameterError("the recorder needs the parameter directory, where it makes the bag")
    return RecorderNode(Path(given.directory), given.stamped, parameters=given.graph_parameters)


def main() -> None:
    """Entry point of the executable ``recorder``."""
    sys.exit(record())
