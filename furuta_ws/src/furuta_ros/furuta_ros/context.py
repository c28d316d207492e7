"""Starting and ending ROS in a process."""

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext

import rclpy
import rclpy.logging
from rclpy.signals import SignalHandlerOptions

from furuta_ros.errors import UserError, first_line
from furuta_ros.middleware import (
    announce_often,
    choose_data_port,
    describe_discovery,
    no_discovery,
    reaches_network,
    remove_empty_ports,
    restrict_discovery,
)

_arguments: list[str] = []


def ros_arguments() -> list[str]:
    """The command-line arguments that ROS was started with."""
    return _arguments


@contextmanager
def ros_context(
    arguments: Sequence[str] | None = (), namespace: str = "", private: bool = False
) -> Iterator[None]:
    """ROS runs inside the ``with`` block and ends with it, on this machine unless chosen otherwise.

    ``arguments`` are command-line arguments; None means those of the process. All nodes that the
    block makes are in ``namespace``. With ``private`` they discover no node of another process.
    Signals keep their Python handlers: rclpy's own would end ROS before the nodes have finished.

    Raises:
        UserError: ROS cannot use the arguments.
    """
    given = None if arguments is None else list(arguments)
    if namespace:
        given = [*(given or []), "--ros-args", "--remap", f"__ns:={namespace}"]
    restrict_discovery()
    announce_often()
    remove_empty_ports()
    choose_data_port()
    _arguments[:] = sys.argv if given is None else given
    with no_discovery() if private else nullcontext():
        try:
            rclpy.init(args=given, signal_handler_options=SignalHandlerOptions.NO)
        except Exception as error:  # rclpy raises types here that it does not export
            unknown = "unknown arguments " if type(error).__name__ == "UnknownROSArgsError" else ""
            reason = f"{unknown}{first_line(error)}"
            if "logging directory" in reason:
                reason += "; set ROS_LOG_DIR or HOME to a directory that can be written"
            raise UserError(f"cannot start ROS: {reason}") from None
        log = rclpy.logging.get_logger("discovery")
        (log.info if reaches_network() else log.debug)(describe_discovery())
        try:
            yield
        finally:
            rclpy.try_shutdown()
