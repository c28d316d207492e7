"""Starting and ending ROS in a process."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import rclpy
import rclpy.logging
from rclpy.signals import SignalHandlerOptions

from furuta_ros.discovery import describe_discovery, reaches_network, restrict_discovery
from furuta_ros.errors import UserError, first_line
from furuta_ros.shared_memory import remove_empty_ports

_arguments: list[str] = []


def ros_arguments() -> list[str]:
    """The command-line arguments that ROS was started with."""
    return _arguments


@contextmanager
def ros_context(arguments: Sequence[str] | None = (), namespace: str = "") -> Iterator[None]:
    """ROS runs inside the ``with`` block and ends with it, on this machine unless chosen otherwise.

    ``arguments`` are command-line arguments; None means those of the process. All nodes that the
    block makes are in ``namespace``. Signals keep their Python handlers: rclpy's own would end
    ROS before the nodes have finished.

    Raises:
        UserError: ROS cannot use the arguments.
    """
    given = None if arguments is None else list(arguments)
    if namespace:
        given = [*(given or []), "--ros-args", "--remap", f"__ns:={namespace}"]
    restrict_discovery()
    remove_empty_ports()
    _arguments[:] = sys.argv if given is None else given
    try:
        rclpy.init(args=given, signal_handler_options=SignalHandlerOptions.NO)
    except Exception as error:  # rclpy raises types here that it does not export
        unknown = "unknown arguments " if type(error).__name__ == "UnknownROSArgsError" else ""
        raise UserError(f"cannot start ROS: {unknown}{first_line(error)}") from None
    log = rclpy.logging.get_logger("discovery")
    (log.info if reaches_network() else log.debug)(describe_discovery())
    try:
        yield
    finally:
        rclpy.try_shutdown()
