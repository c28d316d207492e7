"""Running nodes in a process: one executor, a clean end, errors in one line."""

import gc
import inspect
import sys
from collections.abc import Callable, Iterable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

from rclpy.exceptions import ParameterException
from rclpy.executors import Executor, ExternalShutdownException
from rclpy.experimental import EventsExecutor
from rclpy.node import Node

from furuta_model.parameters import ParameterError, shortened
from furuta_ros.context import ros_context
from furuta_ros.errors import UserError, first_line
from furuta_ros.node import FurutaNode
from furuta_ros.one_graph import claim
from furuta_ros.process import StopSignal, bounded_end, own_arguments

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


def prepare_to_spin() -> None:
    """Do at once what would delay samples later.

    All present objects are excluded from garbage collection. The logger looks up the source of its
    caller, for the first time in 70 ms.
    """
    inspect.getframeinfo(sys._getframe())
    gc.collect()
    gc.freeze()


def run_node(make: Callable[[], FurutaNode[Any]]) -> int:
    """Run one node until it is told to stop; returns the process's exit status.

    The status is 0 if the node was ready, 130 if Ctrl-C ended it before, and 143 after SIGTERM.
    """
    stop = StopSignal()
    given = own_arguments(sys.argv[1:])
    if given:
        program, shown = Path(sys.argv[0]).name, shortened(" ".join(given))
        return fail(f"{program} takes only ROS arguments, after --ros-args; given {shown}", 2)
    try:
        with ros_context(None):
            return _spin_node(make, stop)
    except (ParameterError, ParameterException, UserError) as error:
        return fail(first_line(error))
    except ExternalShutdownException:
        return 0


def _spin_node(make: Callable[[], FurutaNode[Any]], stop: StopSignal) -> int:
    node = make()
    graph = node.context.get_domain_id(), node.get_namespace()
    with claim(*graph) if node.one_per_graph else nullcontext():
        executor = executor_of([node])
        prepare_to_spin()
        if stop():
            return stop.status
        problem = node.start_up()
        if problem:
            node.get_logger().error(f"not ready: {problem}")
        else:
            node.get_logger().info("ready")
        spin_until(executor, stop)
        # The executor first: it would release what the middleware has destroyed with the node.
        executor.shutdown()
        if summary := node.summary():
            print(summary)
        with bounded_end(0):
            node.destroy_node()
    return 0


def fail(reason: str, status: int = 1) -> int:
    """Print the reason on standard error; returns the exit status for it."""
    print(f"error: {reason}", file=sys.stderr)
    return status
