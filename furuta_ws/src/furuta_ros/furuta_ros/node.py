"""What is ROS in a node of the graph: parameters, subscriptions, publishers, warnings, status.

The loop needs every sample, so its topics are reliable. With a depth of a few samples a slow
subscriber gets the newest ones and does not block the publisher.
"""

from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from time import monotonic, time_ns
from typing import Any, Generic, NamedTuple, TypeVar

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import QoSDurabilityPolicy, QoSProfile, QoSReliabilityPolicy
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.timer import Timer

from furuta_model.compiled import load_machinery
from furuta_ros.errors import UserError, described, first_line
from furuta_ros.messages import RefusedError
from furuta_ros.middleware import clock_advice
from furuta_ros.parameters import FurutaParameterService, NodeParameters
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import ARMED, CLOCK, DIAGNOSTICS, Topic

Group = TypeVar("Group", bound=NamedTuple)

QOS = QoSProfile(
    depth=10,
    reliability=QoSReliabilityPolicy.RELIABLE,
    durability=QoSDurabilityPolicy.VOLATILE,
)
# A late subscriber gets the last message, and none before it.
LATCHED = QoSProfile(
    depth=1,
    reliability=QoSReliabilityPolicy.RELIABLE,
    durability=QoSDurabilityPolicy.TRANSIENT_LOCAL,
)
# Robots publish their states either way; a best-effort subscriber receives both.
BEST_EFFORT = QoSProfile(depth=10, reliability=QoSReliabilityPolicy.BEST_EFFORT)

# Shortest time between two messages on the copy, by the stamps of their samples [ns].
COPY_PERIOD = NANOSECONDS // 100
# Shortest time between two warnings of one kind [s], and of what causes them again and again.
WARNING_PERIOD, RARELY = 1.0, 10.0
# Time between two statuses on /diagnostics, and two checks for second publishers [s].
STATUS_PERIOD = 1.0
# Age beyond which a message is ignored in real time [s]: a process that stood still would answer
# the messages of that time by where the rig was.
MAX_AGE = 0.05
_OLDEST = round(MAX_AGE * NANOSECONDS)


def deep(depth: int) -> QoSProfile:
    """The loop's quality of service with a queue of ``depth`` messages, for a slow subscriber."""
    return QoSProfile(depth=depth, reliability=QOS.reliability, durability=QOS.durability)


def beside(node: Node, name: str) -> str:
    """The full name of a node in the namespace of another one."""
    return f"{node.get_namespace().rstrip('/')}/{name}"


def sender(publisher: Publisher) -> Callable[[bytes], None]:
    """Publishes serialised messages.

    ``publisher.publish`` first asks of each message which type it has, for a third of its time.
    """
    send: Callable[[bytes], None] = publisher.handle.publish_raw
    return send


class LoopPublisher:
    """Publishes serialised messages on ``topic``, and some again on its throttled copy.

    A program that draws needs a hundred samples per second. Receiving all of them would cost the
    publisher's process time on every sample.
    """

    def __init__(self, node: Node, topic: Topic) -> None:
        copy = topic.throttled
        self._publisher = node.create_publisher(topic.message, topic.name, QOS)
        self._send = sender(self._publisher)
        self._copy = node.create_publisher(copy.message, copy.name, QOS)
        self._last = -COPY_PERIOD

    def publish(self, data: bytes, stamp: int) -> None:
        """Publish the message of the sample at ``stamp`` [ns]."""
        self._send(data)
        if not self._last <= stamp < self._last + COPY_PERIOD:
            self._last = stamp
            if self._copy.get_subscription_count() > 0:
                self._copy.publish(data)

    def is_wanted(self) -> bool:
        """Whether somebody subscribes to either."""
        publishers = self._publisher, self._copy
        return any(each.get_subscription_count() > 0 for each in publishers)


class FurutaNode(Node, Generic[Group]):
    """A node with a declared group of parameters, and callbacks that survive any message.

    It publishes its status on ``/diagnostics``, under its full name.

    Attributes:
        refused: Number of invalid messages; ``expired``: of those that were too old.
        sent: When the message that the node handles was sent [ns since 1970], 0 if not known.
        parameter_service: What changes the parameters on request.
        runs_compiled_code: Whether to load what compiled code needs before others see the node.
        one_per_graph: Whether a second such node must not start, whatever its name.
    """

    runs_compiled_code = True
    one_per_graph = False

    def __init__(self, name: str, group: type[Group], overrides: Sequence[Parameter] = ()) -> None:
        if self.runs_compiled_code:
            load_machinery()
        try:
            super().__init__(
                name, parameter_overrides=list(overrides), start_parameter_services=False
            )
        except RuntimeError as error:  # of ROS below Python, such as missing security libraries
            raise UserError(f"cannot make the node {name}: {first_line(error)}") from None
        self.guard_services(self.services)
        self.refused = self.expired = self.sent = 0
        self._inputs: list[Topic] = []
        self._warned_at: dict[str, float] = {}
        self._declared = NodeParameters(self, group)
        self.parameter_service = FurutaParameterService(self)
        self._diagnostics = self.create_publisher(DIAGNOSTICS.message, DIAGNOSTICS.name, 10)
        self.steady_timer(STATUS_PERIOD, self.publish_status)

    @property
    def parameters(self) -> Group:
        """The current parameters."""
        return self._declared.current

    def design_by(self, design: Callable[[Group], None]) -> None:
        """Call ``design`` with the parameters now, and again after every change."""
        self._declared.on_change(design)
        design(self.parameters)

    def start_up(self) -> str:
        """Do what is left when the node is about to spin; returns why it is not ready, if so."""
        return ""

    def summary(self) -> str:
        """What its process prints when it ends, in lines; empty by default."""
        return ""

    def problem(self) -> str:
        """Why the node does less than it is asked for; empty if it does all of it."""
        return ""

    def statistics(self) -> dict[str, object]:
        """Numbers for ``/diagnostics``."""
        return {"messages refused": self.refused, "messages too old": self.expired}

    def status(self) -> DiagnosticStatus:
        """WARN with the reason if it has a problem, or one of its inputs has two publishers."""
        if several := self.second_publishers(self._inputs):
            self.warn("publishers", several, RARELY)
        reason = several or self.problem()
        level = DiagnosticStatus.WARN if reason else DiagnosticStatus.OK
        return DiagnosticStatus(level=level, message=reason or "running")

    def publish_status(self) -> None:
        """Publish the status now; a timer does so once a second."""
        status = self.status()
        status.name = self.get_fully_qualified_name()
        pairs = self.statistics().items()
        status.values = [KeyValue(key=key, value=str(value)) for key, value in pairs]
        message = DiagnosticArray(status=[status])
        message.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(message)

    def subscribe_to(
        self, topic: Topic, receive: Callable[[bytes], None], qos: QoSProfile = QOS
    ) -> None:
        """Call ``receive`` with each serialised message of a topic of the graph.

        A message that is too old in real time, or that ``receive`` refuses, is counted and logged.
        With another quality of service the topic is one of a robot: it may have several publishers.
        """
        if qos is QOS:
            self._inputs.append(topic)

        @wraps(_data_and_info)
        def checked(data: Any, info: Any = None) -> None:
            if info is None:  # the events executor of some builds passes both as one tuple
                data, info = data
            self.sent = sent = info["source_timestamp"]
            try:
                if sent and time_ns() - sent > _OLDEST and not self.time_is_simulated():
                    self._ignore(topic)
                else:
                    receive(data)
            except RefusedError as refusal:
                self.refused += 1
                self.warn(f"refused {topic.name}", f"refused a message on {topic.name}: {refusal}")
            except Exception as error:
                self.report_failure(topic.name, error)

        super().create_subscription(topic.message, topic.name, checked, qos, raw=True)

    def second_publishers(self, topics: Sequence[Topic]) -> str:
        """Who publishes a topic besides its publisher; empty if nobody does."""
        for topic in topics:
            name = self.resolve_topic_name(topic.name)
            if self.count_publishers(name) > 1:
                ends = self.get_publishers_info_by_topic(name)
                known = [e for e in ends if e.node_name != UNKNOWN]
                nodes = sorted(f"{e.node_namespace.rstrip('/')}/{e.node_name}" for e in known)
                twice = "" if len(set(nodes)) == len(nodes) else TWICE
                nodes += [NAMELESS] * (len(ends) - len(known))
                return f"{len(nodes)} nodes publish {topic.name}: {' and '.join(nodes)}{twice}"
        return ""

    # All other callbacks come through one of these four, also those of rclpy itself.

    def create_subscription(
        self, msg_type: Any, topic: str, callback: Any, *others: Any, **named: Any
    ) -> Subscription:
        """As in ROS; an exception in the callback does not end the node."""
        callback = self.guarded(topic, callback)
        return super().create_subscription(msg_type, topic, callback, *others, **named)

    def create_service(
        self, srv_type: Any, srv_name: str, callback: Any, *others: Any, **named: Any
    ) -> Service:
        """As in ROS; after an exception in the callback the response is an empty one."""
        callback = self.guarded(srv_name, callback)
        return super().create_service(srv_type, srv_name, callback, *others, **named)

    def create_timer(
        self, timer_period_sec: float, callback: Any, *others: Any, **named: Any
    ) -> Timer:
        """As in ROS; an exception in the callback does not end the node."""
        callback = self.guarded("a timer", callback)
        return super().create_timer(timer_period_sec, callback, *others, **named)

    def run_soon(self, call: Callable[[], object]) -> bool:
        """Let the thread that spins the node call a function; False if none does.

        Any thread may call this. The events executor knows no guard conditions, so it is a task; an
        exception in it would end the executor.
        """
        executor = self.executor
        if executor is not None:
            executor.create_task(self.guarded("a task", call))
        return executor is not None

    def guarded(self, source: str, callback: Callable[..., Any]) -> Callable[..., Any]:
        """The callback, but an exception is logged with its line instead of ending the node."""

        @wraps(callback)
        def call(*given: Any) -> Any:
            try:
                return callback(*given)
            except Exception as error:
                self.report_failure(source, error)
                return given[-1] if given else None  # the response of a service

        return call

    def guard_services(self, services: Iterable[Service]) -> None:
        """Guard services that rclpy has made by itself."""
        for service in services:
            service.callback = self.guarded(service.srv_name, service.callback)

    def steady_timer(self, period: float, call: Callable[[], object]) -> Timer:
        """Call a function every ``period`` [s], whatever happens to the system's time."""
        return self.create_timer(period, call, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def warn(
        self, kind: str, text: str, period: float = WARNING_PERIOD, is_error: bool = False
    ) -> bool:
        """Log a warning or error, but only one of its kind in ``period`` [s]; whether it was.

        The logger's own throttle looks up its caller's source each time: 1 ms that a late loop does
        not have.
        """
        now = monotonic()
        due = kind not in self._warned_at or now - self._warned_at[kind] >= period
        if due:
            self._warned_at[kind] = now
            # Two calls: rclpy raises an exception where one place logs at two levels.
            if is_error:
                self.get_logger().error(text)
            else:
                self.get_logger().warning(text)
        return due

    def time_is_simulated(self) -> bool:
        """Whether the plant of this graph publishes simulated time: it waits for each answer.

        A rig does not, whoever publishes a time.
        """
        simulated, rig = (
            self.count_publishers(self.resolve_topic_name(topic.name)) for topic in (CLOCK, ARMED)
        )
        return simulated > 0 and rig == 0

    def _ignore(self, topic: Topic) -> None:
        self.expired += 1
        age = (time_ns() - self.sent) / NANOSECONDS
        self.warn(
            f"ignored {topic.name}",
            f"ignored a message on {topic.name} that was sent {age:.3g} s ago, at most "
            f"{MAX_AGE:g} s ({self.expired} so far){clock_advice()}",
        )

    def report_failure(self, source: str, error: Exception) -> str:
        """Log an exception that nobody expects, in one line, which is returned."""
        text = f"{source}: {described(error)}"
        self.warn(f"failed {source}", text, is_error=True)
        return text


# Two publishers of the same node's name.
TWICE = " (it runs twice, or one was killed: that one stays listed for up to 20 s)"
# A publisher can be discovered before its node: the name that ROS then gives, and ours.
UNKNOWN, NAMELESS = "_NODE_NAME_UNKNOWN_", "a node whose name is not known yet"


def _data_and_info(data: bytes, info: dict[str, Any]) -> None:
    """Whose signature a callback has tells rclpy to pass it the message info."""
