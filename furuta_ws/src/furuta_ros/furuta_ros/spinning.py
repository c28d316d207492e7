"""ROS in a process: its start, one executor for all nodes, a clean end, errors in one line."""

import gc
import inspect
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import rclpy
import rclpy.logging
from rclpy.duration import Duration
from rclpy.exceptions import ParameterException
from rclpy.executors import Executor, ExternalShutdownException
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from furuta_model.parameters import ParameterError, shortened
from furuta_ros.errors import UserError, first_line
from furuta_ros.middleware import (
    describe_discovery,
    no_discovery,
    prepare_middleware,
    reaches_network,
)
from furuta_ros.node import FurutaNode
from furuta_ros.one_graph import claim
from furuta_ros.process import ROS_ARGUMENTS, StopSignal, bounded_end, own_arguments

try:
    from rclpy.experimental import EventsExecutor
except ModuleNotFoundError:
    raise UserError(
        "this needs rclpy 7.1.4 of April 2025 or newer, and ROS 2 here has an older one; to "
        "upgrade it: sudo apt update && sudo apt upgrade"
    ) from None

# Longest time that the executor spins before a condition is checked again [s]. Its own endless
# spin() delivers nothing in some builds.
SPIN_TIMEOUT = 0.1
# Longest wait for the nodes of this process to discover each other [s].
DISCOVERY_TIMEOUT = 30.0
# Longest wait for the reception of a message: a subscriber of another process may stand still [s].
RECEPTION_TIMEOUT = 1.0


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
    prepare_middleware()
    ROS_ARGUMENTS[:] = sys.argv if given is None else given
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


def executor_of(nodes: Iterable[Node]) -> Executor:
    """One events executor with all nodes; it is ten times as fast as the default one."""
    executor = EventsExecutor()
    for node in nodes:
        executor.add_node(node)
    return executor


def wait_until_matched(nodes: Sequence[Node]) -> None:
    """Return once every publisher of these nodes knows all their subscriptions to its topic.

    In lock-step a message that does not reach a subscriber would stop the run. What was published
    already, for late subscribers, has been received too: the next message would replace it.

    Raises:
        UserError: They do not discover each other.
    """
    required = {
        publisher: sum(
            subscription.topic_name == publisher.topic_name
            for node in nodes
            for subscription in node.subscriptions
        )
        for node in nodes
        for publisher in node.publishers
    }
    deadline = monotonic() + DISCOVERY_TIMEOUT
    while any(p.get_subscription_count() < count for p, count in required.items()):
        if monotonic() > deadline:
            raise UserError("the nodes of this process did not discover each other")
        sleep(0.005)
    for publisher in required:
        publisher.wait_for_all_acked(Duration(seconds=RECEPTION_TIMEOUT))


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
    stop = StopSignal(at_once=True)
    given = own_arguments(sys.argv[1:])
    if given:
        program, shown = Path(sys.argv[0]).name, shortened(" ".join(given))
        return fail(
            f"{program} takes only ROS arguments, after --ros-args; given {shown}; its parameters: "
            f"furuta param defaults {program}",
            2,
        )
    try:
        with ros_context(None):
            return _spin_node(make, stop)
    except (ParameterError, ParameterException, UserError) as error:
        return fail(first_line(error))
    except ExternalShutdownException:
        return 0


def _spin_node(make: Callable[[], FurutaNode[Any]], stop: StopSignal) -> int:
    node = make()
    stop.at_once = False
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
