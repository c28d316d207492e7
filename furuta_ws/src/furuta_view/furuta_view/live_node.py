"""Node ``view``: receives the loop's topics for drawing, without a callback per message.

The middleware keeps the newest messages until :meth:`LiveNode.collect` takes them, some 30 times a
second. Most are dropped unread. The subscriptions are best effort, so that a view that hangs holds
up no publisher.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import nan, pi, remainder
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import ParameterEvent
from rclpy.node import Node
from rclpy.qos import QoSProfile, QoSReliabilityPolicy
from rclpy.serialization import deserialize_message
from rclpy.subscription import Subscription
from sensor_msgs.msg import JointState
from std_msgs.msg import UInt64MultiArray

from furuta_model import topic_names
from furuta_model.state import RIGID_STATES, SIGNALS
from furuta_model.time_stamps import NANOSECONDS, stamp_nanoseconds
from furuta_ros.messages import RefusedError, read_joints
from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, GROUND_TRUTH, JOINT_STATES, TIMING, Topic
from furuta_view.samples import COLUMNS, ESTIMATE, FRICTION, PHI, THETA, TIME, Samples
from furuta_view.samples import COMMAND as COMMAND_COLUMN

# Messages that wait between two collections; in fast lock-step the older ones are dropped.
DEPTH = 256
# Samples kept per second of the loop's time, and for how long [s].
RATE = 100
KEPT = 12
PERIOD = NANOSECONDS // RATE

PARAMETER_EVENTS = Topic(topic_names.PARAMETER_EVENTS, ParameterEvent)
DIAGNOSTICS = Topic("/diagnostics", DiagnosticArray)


class LiveNode(Node):
    """Collects samples of the true state, where there is one, or of the estimated state.

    ``samples`` are the newest ones, ``timing`` the newest message on ``timing`` and ``status`` the
    newest status of the bridge, or None. ``on_parameters`` is called with each parameter event.
    """

    def __init__(self, on_parameters: Callable[[ParameterEvent], None]) -> None:
        super().__init__("view", start_parameter_services=False)
        self.samples = Samples(RATE * KEPT)
        self.timing: UInt64MultiArray | None = None
        self.status: Any = None
        self._on_parameters = on_parameters
        self._last_stamp = -PERIOD
        self._x = np.zeros(SIGNALS)
        self._state_topic: Topic = JOINT_STATES
        self._states = self._subscribe(JOINT_STATES)
        self._estimate, self._command = map(self._subscribe, (FRICTION_ESTIMATE, COMMAND))
        self._timing = self._subscribe(TIMING)
        self._diagnostics = self._subscribe(DIAGNOSTICS)
        self._events = self._subscribe(PARAMETER_EVENTS, 1000)

    @property
    def has_truth(self) -> bool:
        """Whether the true state is published."""
        return self.count_publishers(self.resolve_topic_name(GROUND_TRUTH.name)) > 0

    def choose_state(self) -> None:
        """Subscribe to the true state while it is published, otherwise to the estimate."""
        wanted = GROUND_TRUTH if self.has_truth else JOINT_STATES
        if wanted is not self._state_topic:
            self.destroy_subscription(self._states)
            self._states, self._state_topic = self._subscribe(wanted), wanted

    def collect(self) -> None:
        """Take what has arrived since the last call."""
        states = list(_take(self._states))
        estimates, commands = (_floats(each) for each in (self._estimate, self._command))
        for index, message in enumerate(states):
            self._add(message, *(_at(each, index, len(states)) for each in (estimates, commands)))
        for message in _take(self._events):
            self._on_parameters(deserialize_message(message, ParameterEvent))
        for message in _take(self._timing):
            self.timing = deserialize_message(message, UInt64MultiArray)
        for message in _take(self._diagnostics):
            self._keep_status(deserialize_message(message, DiagnosticArray))

    def _add(self, serialized: bytes, estimate: float, command: float) -> None:
        """Keep a sample if the last one that was kept is old enough."""
        seconds, nanoseconds = np.frombuffer(serialized, "<i4,<u4", 1, 4)[0].item()
        stamp = seconds * NANOSECONDS + nanoseconds
        if 0 <= stamp - self._last_stamp < PERIOD:
            return
        message = deserialize_message(serialized, JointState)
        try:
            read_joints(message, self._x, partly=True)
        except RefusedError:
            return
        self._last_stamp = stamp_nanoseconds(message)
        sample = np.full(COLUMNS, nan)
        sample[TIME] = self._last_stamp / NANOSECONDS
        sample[PHI : PHI + RIGID_STATES] = self._x[:RIGID_STATES]
        sample[THETA] = remainder(sample[THETA], 2 * pi)  # a pendulum that fell may have turned
        if self._state_topic is GROUND_TRUTH:
            sample[FRICTION] = self._x[RIGID_STATES]
        sample[ESTIMATE], sample[COMMAND_COLUMN] = estimate, command
        self.samples.add(sample)

    def _keep_status(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name.endswith(": rig"):
                self.status = status

    def _subscribe(self, topic: Topic, depth: int = DEPTH) -> Subscription:
        reliability = QoSReliabilityPolicy.RELIABLE if depth > DEPTH else None
        qos = QoSProfile(depth=depth, reliability=reliability or QoSReliabilityPolicy.BEST_EFFORT)
        return self.create_subscription(topic.type, topic.name, _never_called, qos, raw=True)


def _take(subscription: Subscription) -> Iterator[bytes]:
    """The serialized messages that have arrived."""
    with subscription.handle:
        while (taken := subscription.handle.take_message(subscription.msg_type, True)) is not None:
            yield taken[0]


def _floats(subscription: Subscription) -> np.ndarray:
    """The numbers that have arrived on a topic of Float64."""
    return np.array([np.frombuffer(each, "<f8", 1, 4)[0] for each in _take(subscription)])


def _at(numbers: np.ndarray, index: int, count: int) -> float:
    """The number that arrived with message ``index`` of ``count`` on another topic."""
    return float(numbers[index * len(numbers) // count]) if len(numbers) else nan


def _never_called(message: Any) -> None:
    """Callback of subscriptions that no executor serves."""
