"""Running nodes in a process: one executor, a clean end, errors in one line."""

from __future__ import annotations

import gc
import signal
import sys
from collections.abc import Callable, Iterable
from types import FrameType

from rclpy.exceptions import ParameterException
from rclpy.executors import Executor, ExternalShutdownException
from rclpy.experimental import EventsExecutor
from rclpy.node import Node

from furuta_model.parameters import ParameterError
from furuta_ros.context import ros_context
from furuta_ros.errors import UserError, first_line

# Longest time that the executor spins before a condition is checked again [s]. Its own endless
# spin() delivers nothing in some builds.
SPIN_TIMEOUT = 0.1


def executor_of(nodes: Iterable[Node]) -> Executor:
    """One events executor with all nodes; it is ten times as fast as the default one."""
    executor = EventsExecutor()
    for node in nodes:
        executor.add_node(node)
    return executor


def spin_until(executor: Executor, done: Callable[[], bool]) -> None:
    """Spin until ``done()``, which is checked at least every ``SPIN_TIMEOUT`` seconds."""
    while not done():
        executor.spin_once(timeout_sec=SPIN_TIMEOUT)


def freeze_startup_objects() -> None:
    """Exclude all present objects from garbage collection, which would delay samples."""
    gc.collect()
    gc.freeze()


class StopSignal:
    """Becomes true when the process receives SIGINT or SIGTERM."""

    def __init__(self) -> None:
        self._received = False
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._receive)

    def _receive(self, number: int, frame: FrameType | None) -> None:
        self._received = True

    def __call__(self) -> bool:
        """Whether the process has received a signal to stop."""
        return self._received


def run_node(make: Callable[[], Node], arguments: list[str] | None = None) -> int:
    """Run one node until it is told to stop; returns the process's exit status."""
    stop = StopSignal()
    try:
        with ros_context(arguments):
            node = make()
            freeze_startup_objects()
            node.get_logger().info("ready")
            spin_until(executor_of([node]), stop)
            node.destroy_node()
    except (ParameterError, ParameterException, UserError) as error:
        return fail(first_line(error))
    except ExternalShutdownException:
        pass
    return 0


def fail(reason: str) -> int:
    """Print the reason on standard error; returns the exit status for it."""
    print(f"error: {reason}", file=sys.stderr)
    return 1
