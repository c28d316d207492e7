"""Base class of the nodes that take a step for each sample of a topic with time stamps."""

from abc import abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState

from furuta_model.compiled import compiled, for_types_of
from furuta_model.state import EFFORT, SIGNALS
from furuta_ros.loop_publisher import LoopPublisher
from furuta_ros.messages import deserialized
from furuta_ros.node import FurutaNode
from furuta_ros.time_stamps import stamp_nanoseconds
from furuta_ros.topics import Topic
from furuta_ros.wire import REPEATED, UNUSUAL, new_joint_state, write_joint_state

Group = TypeVar("Group", bound=NamedTuple)


class SampleNode(FurutaNode[Group]):
    """A node that takes one step for each sample, from serialised message to serialised message.

    One compiled call reads the message, computes and writes the answer. A message that is not in
    the usual layout goes through its typed form and :meth:`read` first. A sample that is repeated
    (same stamp) makes no new step.

    Attributes:
        stamp: Time stamp of the newest sample [ns].
        received: The state or measurement (5,) of the newest sample.
        answer: The serialised answer (1,), see :mod:`furuta_ros.wire`.
    """

    def __init__(
        self, name: str, group: type[Group], answer: np.ndarray, overrides: Sequence[Parameter]
    ) -> None:
        self.stamp = -1
        self.received = np.zeros(SIGNALS)
        self.answer = answer
        self._condition = 0
        self._usual = new_joint_state()
        super().__init__(name, group, overrides)

    def compute_with(self, take: Callable[..., tuple[int, int, int]], *arguments: Any) -> None:
        """Take samples by a compiled function from now on.

        It is called with the serialised sample, the stamp of the last one [ns], :attr:`received`,
        :attr:`answer` and ``arguments``. It returns what the sample is
        (:data:`~furuta_ros.wire.UNUSUAL` to ``ANEW``), its stamp [ns], and what :meth:`report` is
        to say about it, 0 for nothing.
        """
        self._arguments = arguments
        self._take = for_types_of(
            take, self._usual.tobytes(), self.stamp, self.received, self.answer, *arguments
        )

    def take_samples(self, topic: Topic, answers: Topic) -> None:
        """Take a step for each sample on one topic, and publish the answers on another."""
        self._publisher = LoopPublisher(self, answers)
        self.subscribe_to(topic, self._on_sample, raw=True)

    @abstractmethod
    def read(self, message: JointState, x: np.ndarray) -> None:
        """Write the numbers of a sample to ``x`` (5,). Raises RefusedError if it is invalid."""

    def report(self, condition: int, interval: int) -> None:
        """Log what there is to say about a new sample, ``interval`` [ns] after the last one.

        It is called for each sample with a condition, and for the first one without.
        """

    def taken(self, sample: int) -> None:
        """Answer the sample that has been taken."""
        self.publish_answer()

    def publish_answer(self) -> None:
        """Publish the answer, unless it is too old."""
        if self.message_age.answerable():
            self._publisher.publish(self.answer.tobytes(), self.stamp)

    def _on_sample(self, data: bytes) -> None:
        previous = self.stamp
        sample, stamp, condition = self._take(
            data, previous, self.received, self.answer, *self._arguments
        )
        if sample == UNUSUAL:
            usual = self._in_usual_layout(data)
            sample, stamp, condition = self._take(
                usual, previous, self.received, self.answer, *self._arguments
            )
        self.stamp = stamp
        if sample != REPEATED and (condition or self._condition):
            self._condition = condition
            self.report(condition, stamp - previous)
        self.taken(sample)

    def _in_usual_layout(self, data: bytes) -> bytes:
        """The same sample in the usual layout. Raises RefusedError if it is none."""
        message = deserialized(data, JointState)
        x = np.zeros(SIGNALS)
        self.read(message, x)
        _write(self._usual, stamp_nanoseconds(message), x)
        return self._usual.tobytes()


@compiled
def _write(message: np.ndarray, stamp: int, x: np.ndarray) -> None:
    write_joint_state(message[0], stamp, x, x[EFFORT])
