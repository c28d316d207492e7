"""Base class of the plant node, as :mod:`.lockstep` and :mod:`.realtime` use it: its time."""

from abc import abstractmethod
from collections.abc import Callable, Sequence

from rclpy.parameter import Parameter

from furuta_ros.node import FurutaNode
from furuta_ros.time_stamps import NANOSECONDS
from furuta_sim.parameters import PlantNodeParameters


class PacedNode(FurutaNode[PlantNodeParameters]):
    """A plant whose samples are started by a pacing, in lock-step or in real time.

    Attributes:
        sample: Number of the current sample.
        period: Sample time [ns].
        start: Time stamp of sample 0 [ns].
        paused_from: Number of samples from which ``run_until`` is reached.
        held: Whether the rig is held in its initial state.
        on_change: Called after every change of parameters.
    """

    one_per_graph = True

    def __init__(self, name: str, overrides: Sequence[Parameter] = ()) -> None:
        self.sample = 0
        self.start = 0
        self.paused_from = 0.0
        self.held = True
        self.on_change: Callable[[], None] = lambda: None
        super().__init__(name, PlantNodeParameters, overrides)
        self.period = round(self.parameters.plant.sample_time * NANOSECONDS)

    @property
    def time(self) -> float:
        """Time since the start [s]."""
        return self.sample * self.period / NANOSECONDS

    @property
    def stamp(self) -> int:
        """Time stamp of this sample [ns]."""
        return self.start + self.sample * self.period

    @property
    def paused(self) -> bool:
        """Whether ``run_until`` is reached."""
        return self.sample >= self.paused_from

    @abstractmethod
    def move(self, command: float) -> None:
        """Move the rig by one sample under ``command`` [V]."""

    @abstractmethod
    def publish_sample(self) -> None:
        """Read the sensors and publish the measurement and the true state."""

    @abstractmethod
    def repeat_measurement(self) -> None:
        """Publish the measurement of this sample again."""
