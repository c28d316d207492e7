"""Base class of the nodes that take a step for each sample of a topic with time stamps."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import NamedTuple, TypeVar

from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState

from furuta_ros.node import FurutaNode
from furuta_ros.time_stamps import stamp_nanoseconds, starts_anew
from furuta_ros.topics import Topic

Group = TypeVar("Group", bound=NamedTuple)


class SampleNode(FurutaNode[Group]):
    """A node that takes one step for each sample.

    A message becomes numbers in :meth:`read`; the node's core computes with them in :meth:`step`;
    its numbers become a message in :meth:`answer`. A sample that is repeated (same stamp) makes no
    new step.

    Attributes:
        stamp: Time stamp of the newest sample [ns].
    """

    def __init__(self, name: str, group: type[Group], overrides: Sequence[Parameter]) -> None:
        self.stamp = -1
        super().__init__(name, group, overrides)

    def take_samples(self, topic: Topic) -> None:
        """Take a step for each sample on this topic."""
        self.subscribe_to(topic, self._on_sample)

    @abstractmethod
    def read(self, message: JointState) -> None:
        """Keep the numbers of a new sample. Raises RefusedError if the message is invalid."""

    @abstractmethod
    def reset(self) -> None:
        """Forget the motion: the next step does not continue it."""

    @abstractmethod
    def step(self, interval: int, continues: bool) -> None:
        """Compute with the new sample, ``interval`` [ns] after the one before."""

    @abstractmethod
    def answer(self) -> None:
        """Publish what the newest step has computed."""

    def repeat(self) -> None:
        """Answer a repeated sample."""
        self.answer()

    def _on_sample(self, message: JointState) -> None:
        stamp = stamp_nanoseconds(message)
        if stamp == self.stamp:
            self.repeat()
            return
        self.read(message)
        previous, self.stamp = self.stamp, stamp
        continues = not starts_anew(previous, stamp)
        if not continues:
            self.reset()
        self.step(stamp - previous, continues)
