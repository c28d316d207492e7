"""Node ``view``: receives the loop's topics for drawing, without a callback per message.

It subscribes to the throttled copies of the topics, about a hundred messages per second, so that it
costs the loop little. A node of another kind may have no throttled copy; then every message is
received. The middleware keeps the newest ones until :meth:`LiveNode.collect` takes them, some 30
times a second. The subscriptions are best effort, so that a view that hangs holds up no publisher.
"""

from collections.abc import Callable, Iterator
from contextlib import suppress
from math import nan, pi, remainder
from time import monotonic
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rcl_interfaces.msg import ParameterEvent
from rclpy.node import Node
from rclpy.qos import QoSProfile, QoSReliabilityPolicy
from rclpy.subscription import Subscription
from std_msgs.msg import UInt64MultiArray

from furuta.settings.nodes import HARDWARE_BRIDGE
from furuta_bringup.page.samples import COLUMNS, ESTIMATE, FRICTION, PHI, THETA, TIME, Samples
from furuta_bringup.page.samples import COMMAND as COMMAND_COLUMN
from furuta_model.state import RIGID_STATES, SIGNALS, is_possible
from furuta_ros.messages import RefusedError, deserialized, typed_joint_state, value_of
from furuta_ros.node import LATCHED, beside
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import (
    COMMAND,
    DIAGNOSTICS,
    FRICTION_ESTIMATE,
    GROUND_TRUTH,
    INITIAL_STATE,
    JOINT_STATES,
    PARAMETER_EVENTS,
    TIMING,
    Topic,
)
from furuta_ros.wire import unpack_joint_state

# Messages that wait between two collections; in fast lock-step the older ones are dropped. But no
# change of a parameter is lost.
NEWEST_QOS = QoSProfile(depth=1000, reliability=QoSReliabilityPolicy.BEST_EFFORT)
EVENTS_QOS = QoSProfile(depth=1000, reliability=QoSReliabilityPolicy.RELIABLE)
# Samples kept per second of the loop's time, and for how long [s].
RATE = 100
KEPT = 12
PERIOD = NANOSECONDS // RATE
# How long a number counts as the newest one if no other arrives [s].
OLDEST = 0.5
# Bytes of a serialised JointState up to the end of its stamp.
SMALLEST = 12


class LiveNode(Node):
    """Collects samples of the true state, where there is one, or of the estimated state.

    ``samples`` are the newest ones, ``timing`` the newest message on ``timing`` and ``status`` the
    newest status of the bridge, or None, received at ``status_time`` [s] of the steady clock.
    ``warnings`` holds by name why other nodes of its namespace do less than they are asked for.
    ``on_parameters`` is called with each parameter event, ``on_beginning`` with the time [s] and
    the angles of arm and pendulum [rad] when the plant begins a new motion.
    """

    def __init__(
        self,
        on_parameters: Callable[[ParameterEvent], None],
        on_beginning: Callable[[float, float, float], None],
    ) -> None:
        super().__init__("view", start_parameter_services=False)
        self.samples = Samples(RATE * KEPT)
        self.timing: UInt64MultiArray | None = None
        self.status: Any = None
        self.status_time = 0.0
        self.warnings: dict[str, str] = {}
        self._on_parameters, self._on_beginning = on_parameters, on_beginning
        self._last_stamp = -PERIOD
        self._x = np.zeros(SIGNALS)
        self._state, self._estimate, self._command = (
            Input(self, topic) for topic in (JOINT_STATES, FRICTION_ESTIMATE, COMMAND)
        )
        self._timing = self.subscribe(TIMING)
        self._diagnostics = self.subscribe(DIAGNOSTICS)
        self._events = self.subscribe(PARAMETER_EVENTS, EVENTS_QOS)
        self._beginnings = self.subscribe(INITIAL_STATE, LATCHED)

    @property
    def has_truth(self) -> bool:
        """Whether the true state is published."""
        return self.is_published(GROUND_TRUTH)

    def is_published(self, topic: Topic) -> bool:
        """Whether a publisher of the topic is known."""
        return self.count_publishers(self.resolve_topic_name(topic.name)) > 0

    def choose_topics(self) -> None:
        """Subscribe to the true state while it is published, otherwise to the estimate.

        Of each topic to the throttled copy, unless only the topic itself is published.
        """
        self._state.topic = GROUND_TRUTH if self.has_truth else JOINT_STATES
        for loop_input in (self._state, self._estimate, self._command):
            loop_input.choose()

    def collect(self) -> None:
        """Take what has arrived since the last call."""
        # A beginning is taken before the states and told after them: none of the motion before it
        # comes later.
        beginnings = list(_take(self._beginnings))
        states = list(self._state.take())
        estimates, commands = self._estimate.numbers(), self._command.numbers()
        for index, message in enumerate(states):
            place = index, len(states)
            self._add(message, _at(estimates, *place), _at(commands, *place))
        for event in _messages(self._events):
            self._on_parameters(event)
        for timing in _messages(self._timing):
            self.timing = timing
        for message in _messages(self._diagnostics):
            self._keep_status(message)
        for beginning in beginnings:
            self._tell_beginning(beginning)

    def _tell_beginning(self, serialized: bytes) -> None:
        with suppress(RefusedError):
            stamp, state = unpack_joint_state(serialized) or typed_joint_state(serialized)
            if np.isfinite(state).all():
                self._on_beginning(stamp / NANOSECONDS, state[0], state[2])

    def _add(self, serialized: bytes, estimate: float, command: float) -> None:
        """Keep a sample if the last one that was kept is old enough."""
        if len(serialized) < SMALLEST:
            return
        seconds, nanoseconds = np.frombuffer(serialized, "<i4,<u4", 1, 4)[0].item()
        stamp = seconds * NANOSECONDS + nanoseconds
        if 0 <= stamp - self._last_stamp < PERIOD:
            return
        try:
            read = unpack_joint_state(serialized) or typed_joint_state(serialized)
        except RefusedError:
            return
        self._last_stamp, self._x[:] = read
        if not is_possible(self._x):
            return
        sample = np.full(COLUMNS, nan)
        sample[TIME] = self._last_stamp / NANOSECONDS
        sample[PHI : THETA + 1] = self._x[: THETA + 1 - PHI]
        sample[THETA] = remainder(sample[THETA], 2 * pi)  # a pendulum that fell may have turned
        if self._state.topic is GROUND_TRUTH:
            sample[FRICTION] = self._x[RIGID_STATES]
        sample[ESTIMATE], sample[COMMAND_COLUMN] = estimate, command
        self.samples.add(sample)

    def _keep_status(self, message: DiagnosticArray) -> None:
        for status in message.status:
            name = status.name.rpartition("/")[2]
            if status.name != beside(self, name):  # of another graph, or of another program
                continue
            if name == HARDWARE_BRIDGE:
                self.status, self.status_time = status, monotonic()
            elif status.level != DiagnosticStatus.OK:
                self.warnings[name] = status.message
            else:
                self.warnings.pop(name, None)

    def subscribe(self, topic: Topic, qos: QoSProfile = NEWEST_QOS) -> Subscription:
        """A subscription whose messages wait until they are taken."""
        return self.create_subscription(topic.message, topic.name, _never_called, qos, raw=True)


class Input:
    """A subscription of ``node`` to the throttled copy of ``topic``, or to the topic itself."""

    def __init__(self, node: LiveNode, topic: Topic) -> None:
        self._node, self.topic = node, topic
        self._subscribed = topic.throttled
        self._subscription = node.subscribe(self._subscribed)
        self._newest, self._received = np.full(1, nan), 0.0

    def choose(self) -> None:
        """Subscribe to the one that is published."""
        is_throttled = self._node.is_published(self.topic.throttled)
        only_itself = not is_throttled and self._node.is_published(self.topic)
        wanted = self.topic if only_itself else self.topic.throttled
        if wanted != self._subscribed:
            self._node.destroy_subscription(self._subscription)
            self._subscription, self._subscribed = self._node.subscribe(wanted), wanted

    def take(self) -> Iterator[bytes]:
        """The serialized messages that have arrived."""
        return _take(self._subscription)

    def numbers(self) -> np.ndarray:
        """The numbers that have arrived, or the newest one while it is not old."""
        if len(new := _floats(self.take())):
            self._newest, self._received = new[-1:], monotonic()
            return new
        return self._newest if monotonic() - self._received < OLDEST else np.full(1, nan)


def _take(subscription: Subscription) -> Iterator[bytes]:
    """The serialized messages that have arrived."""
    with subscription.handle:
        while (taken := subscription.handle.take_message(subscription.msg_type, True)) is not None:
            yield taken[0]


def _messages(subscription: Subscription) -> Iterator[Any]:
    """The messages that have arrived."""
    for message in _take(subscription):
        with suppress(RefusedError):
            yield deserialized(message, subscription.msg_type)


def _floats(messages: Iterator[bytes]) -> np.ndarray:
    """The numbers in serialized messages of type Float64."""
    numbers = []
    for message in messages:
        with suppress(RefusedError):
            numbers.append(value_of(message))
    return np.array(numbers)


def _at(numbers: np.ndarray, index: int, count: int) -> float:
    """The number that arrived with message ``index`` of ``count`` on another topic."""
    return float(numbers[index * len(numbers) // count]) if len(numbers) else nan


def _never_called(message: Any) -> None:
    """Callback of subscriptions that no executor serves."""
