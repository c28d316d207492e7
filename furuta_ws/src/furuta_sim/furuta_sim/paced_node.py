"""Base class of the plant node, as :mod:`.lockstep` and :mod:`.realtime` use it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

from rclpy.parameter import Parameter

from furuta_ros.node import FurutaNode
from furuta_sim.parameters import PlantNodeParameters


class PacedNode(FurutaNode[PlantNodeParameters], ABC):
    """A plant whose samples are started by a pacing, in lock-step or in real time.

    Attributes:
        sample: Number of the current sample.
        start: Time stamp of sample 0 [ns].
        held: Whether the rig is held in its initial state.
        on_change: Called after every change of parameters.
    """

    def __init__(self, name: str, overrides: Sequence[Parameter] = ()) -> None:
        self.sample = 0
        self.start = 0
        self.held = True
        self.on_change: Callable[[], None] = lambda: None
        super().__init__(name, PlantNodeParameters, overrides)

    @property
    @abstractmethod
    def stamp(self) -> int:
        """Time stamp of this sample [ns]."""

    @property
    @abstractmethod
    def paused(self) -> bool:
        """Whether ``run_until`` is reached."""

    @abstractmethod
    def move(self, command: float) -> None:
        """Move the rig by one sample under ``command`` [V]."""

    @abstractmethod
    def publish_sample(self) -> None:
        """Read the sensors and publish the measurement and the true state."""

    @abstractmethod
    def repeat_measurement(self) -> None:
        """Publish the measurement of this sample again."""
