"""Running nodes in a process: one executor, clean end, errors in one line."""

from __future__ import annotations

import gc
import signal
import sys
from collections.abc import Callable, Iterable
from types import FrameType

import rclpy
from rclpy.exceptions import ParameterException
from rclpy.executors import Executor, ExternalShutdownException
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from furuta_model.parameters import ParameterError

# The executor's own endless spin() delivers nothing in some builds, so it is asked in turns.
TURN = 0.1


def executor_of(nodes: Iterable[Node]) -> Executor:
    """One events executor with all nodes; it is ten times as fast as the default one."""
    executor = EventsExecutor()
    for node in nodes:
        executor.add_node(node)
    return executor


def spin_until(executor: Executor, done: Callable[[], bool]) -> None:
    """Spin until ``done()``, looking at least every ``TURN`` seconds."""
    while not done():
        executor.spin_once(timeout_sec=TURN)


def settle_memory() -> None:
    """Keep the garbage collector from walking what start-up made in the middle of a sample."""
    gc.collect()
    gc.freeze()


class StopSignal:
    """Becomes true at SIGINT or SIGTERM."""

    def __init__(self) -> None:
        self._asked = False
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._ask)

    def _ask(self, number: int, frame: FrameType | None) -> None:
        self._asked = True

    def __call__(self) -> bool:
        """Whether the process was asked to stop."""
        return self._asked


def run_node(make: Callable[[], Node], arguments: list[str] | None = None) -> int:
    """Run one node until it is told to stop; returns the process's exit status."""
    stop = StopSignal()
    try:
        rclpy.init(args=arguments, signal_handler_options=SignalHandlerOptions.NO)
    except Exception as error:  # rclpy raises its own, unexported, types here
        return fail(f"cannot start: {_first_line(error)}")
    try:
        node = make()
        settle_memory()
        node.get_logger().info("ready")
        spin_until(executor_of([node]), stop)
        node.destroy_node()
    except (ParameterError, ParameterException) as error:
        return fail(_first_line(error))
    except ExternalShutdownException:
        pass
    finally:
        rclpy.try_shutdown()
    return 0


def fail(reason: str) -> int:
    """Say why on standard error; returns the exit status for it."""
    print(f"error: {reason}", file=sys.stderr)
    return 1


def _first_line(error: Exception) -> str:
    """What the error says, without the places in ROS's own sources that it ends with."""
    return str(error).strip().splitlines()[0].partition(", at /")[0]
