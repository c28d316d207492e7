"""Base class of the graph's nodes: declared parameters and validated subscriptions."""

from collections.abc import Callable, Sequence
from functools import partial, wraps
from time import monotonic
from traceback import extract_tb
from typing import Any, Generic, NamedTuple, TypeVar

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.timer import Timer

from furuta_model.compiled import load_machinery
from furuta_ros.discovery import clock_advice
from furuta_ros.errors import UserError, first_line
from furuta_ros.loop_topics import publishers_of
from furuta_ros.message_age import MAX_AGE, MessageAge
from furuta_ros.messages import RefusedError
from furuta_ros.one_publisher import OnePublisher
from furuta_ros.parameter_service import FurutaParameterService
from furuta_ros.parameters import NodeParameters
from furuta_ros.topics import CLOCK, QOS, Topic

Group = TypeVar("Group", bound=NamedTuple)

# Shortest time between two warnings of one kind [s].
WARNING_PERIOD = 1.0
# The same of what a fallen pendulum causes again and again.
RARELY = 10.0
# Time between two checks for second publishers [s].
CHECK_PERIOD = 1.0


class FurutaNode(Node, Generic[Group]):
    """A node with a declared group of parameters and validated subscriptions.

    Attributes:
        refused: Number of invalid messages.
        accepted_publishers: By topic name, which publisher's messages are accepted.
        message_age: Of the message that the node answers.
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
        self.refused = 0
        self._warned_at: dict[str, float] = {}
        self.accepted_publishers: dict[str, OnePublisher] = {}
        self.message_age = MessageAge(self._time_is_simulated)
        self._declared = NodeParameters(self, group)
        self.parameter_service = FurutaParameterService(self)

    @property
    def parameters(self) -> Group:
        """The current parameters."""
        return self._declared.current

    def watch_parameters(self, apply: Callable[[Group], None]) -> None:
        """Call ``apply`` with the parameters now, and again after every change.

        A node's constructor calls it once the attributes that ``apply`` needs are there.
        """
        self._declared.on_change(apply)
        apply(self.parameters)

    def start_up(self) -> str:
        """Do what is left when the node is about to spin; returns why it is not ready, if so."""
        return ""

    def publish_on(self, topic: Topic) -> Publisher:
        """A publisher on a topic of the graph."""
        return self.create_publisher(topic.type, topic.name, QOS)

    def subscribe_to(self, topic: Topic, receive: Callable[[Any], None], raw: bool = False) -> None:
        """Call ``receive`` with each message from the one publisher of the topic.

        With ``raw`` it gets the serialised message, in bytes. A message that is too old or that
        ``receive`` refuses is counted and logged.
        """
        one = OnePublisher(
            topic.name, partial(publishers_of, self, topic), self.get_logger().warning
        )
        self.accepted_publishers[topic.name] = one

        accepts, age = one.accepts, self.message_age

        @wraps(_message_and_info)
        def checked(*taken: Any) -> None:
            # The events executor of some builds passes both as one tuple.
            message, info = taken if len(taken) == 2 else taken[0]
            if not accepts(info["publication_sequence_number"]):
                return
            if not age.received(info["source_timestamp"]):
                self._report_age(topic)
                return
            try:
                receive(message)
            except RefusedError as refusal:
                self.refused += 1
                self.warn(f"refused {topic.name}", f"refused a message on {topic.name}: {refusal}")
            except Exception as error:
                self._report_failure(topic.name, error)

        super().create_subscription(topic.type, topic.name, checked, QOS, raw=raw)
        self.steady_timer(CHECK_PERIOD, one.check)

    # All other callbacks come through one of these three, also those of rclpy itself.

    def create_subscription(
        self, msg_type: Any, topic: str, callback: Any, *others: Any, **named: Any
    ) -> Subscription:
        """As in ROS; an exception in the callback does not end the node."""
        return super().create_subscription(
            msg_type, topic, self.guarded(topic, callback), *others, **named
        )

    def create_service(
        self, srv_type: Any, srv_name: str, callback: Any, *others: Any, **named: Any
    ) -> Service:
        """As in ROS; after an exception in the callback the response is an empty one."""
        return super().create_service(
            srv_type, srv_name, self.guarded(srv_name, callback), *others, **named
        )

    def create_timer(
        self, timer_period_sec: float, callback: Any, *others: Any, **named: Any
    ) -> Timer:
        """As in ROS; an exception in the callback does not end the node."""
        return super().create_timer(
            timer_period_sec, self.guarded("a timer", callback), *others, **named
        )

    def guarded(self, source: str, callback: Callable[..., Any]) -> Callable[..., Any]:
        """The callback, but an exception is logged with its line instead of ending the node."""

        @wraps(callback)
        def call(*given: Any) -> Any:
            try:
                return callback(*given)
            except Exception as error:
                self._report_failure(source, error)
                return given[-1] if given else None  # the response of a service

        return call

    def _report_failure(self, source: str, error: Exception) -> None:
        *_, (file, line, name, _) = extract_tb(error.__traceback__)
        reason = f"{type(error).__name__}: {error}"
        text = f"{source}: {name} failed ({file}, line {line}): {reason}"
        self.warn(f"failed {source}", text, severity="error")

    def steady_timer(self, period: float, call: Callable[[], object]) -> Timer:
        """Call a function every ``period`` [s], whatever happens to the system's time."""
        return self.create_timer(period, call, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def warn(
        self, kind: str, text: str, period: float = WARNING_PERIOD, severity: str = "warning"
    ) -> bool:
        """Log a warning, but only one of its kind in ``period`` [s]; whether it was logged.

        The logger's own throttle looks up its caller's source each time: 1 ms that a late loop does
        not have.
        """
        now = monotonic()
        due = kind not in self._warned_at or now - self._warned_at[kind] >= period
        if due:
            self._warned_at[kind] = now
            getattr(self.get_logger(), severity)(text)
        return due

    def _time_is_simulated(self) -> bool:
        """Whether the plant of this graph publishes simulated time."""
        return self.count_publishers(self.resolve_topic_name(CLOCK.name)) > 0

    def _report_age(self, topic: Topic) -> None:
        self.warn(
            f"ignored {topic.name}",
            f"ignored a message on {topic.name} that was sent {self.message_age.age:.3g} s ago, "
            f"at most {MAX_AGE:g} s ({self.message_age.expired} so far){clock_advice()}",
        )


def _message_and_info(message: Any, info: dict[str, Any]) -> None:
    """Whose signature a callback has tells rclpy to pass it the message info."""
