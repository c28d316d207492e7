"""Node ``plant``: command → measurement and ground_truth, in real time or in lock-step."""

import sys
from collections.abc import Sequence

from rclpy.parameter import Parameter

from furuta_ros.messages import read_value
from furuta_ros.spinning import run_node
from furuta_ros.topics import COMMAND
from furuta_sim.lockstep import LockStep
from furuta_sim.realtime import RealTime
from furuta_sim.simulated_plant import SimulatedPlant


class PlantNode(SimulatedPlant):
    """Simulates the rig.

    Publishes ``measurement`` (NaN without a sensor; effort of the arm: the torque applied since
    the last one [V]) and ``ground_truth`` (effort: the true friction [V]); subscribes to
    ``command`` [V]. :class:`RealTime` or :class:`LockStep` starts the samples.
    """

    def __init__(self, overrides: Sequence[Parameter] = ()) -> None:
        super().__init__(overrides)
        is_lockstep = self.parameters.clock == "lockstep"
        self.parameter_service.limited = not is_lockstep  # run_until may be set for every step
        self.pacing: LockStep | RealTime = LockStep(self) if is_lockstep else RealTime(self)
        self.design_by(lambda _: self.pacing.resume())
        self.subscribe_to(COMMAND, self.on_command)

    def summary(self) -> str:
        """Samples and time; in real time how late commands and measurements were."""
        lines = [f"{self.sample} samples, {self.time:.3f} s"]
        if isinstance(self.pacing, RealTime):
            lines += self.pacing.summary()
        return "\n".join(lines)

    def statistics(self) -> dict[str, object]:
        """Also the counts of real time."""
        timing = self.pacing.timing_counts if isinstance(self.pacing, RealTime) else None
        return super().statistics() | (timing._asdict() if timing else {})

    def on_command(self, data: bytes) -> None:
        """Take a command [V]."""
        command = read_value(data)
        # A command during a reset belongs to a measurement from before it.
        self.held = self._is_resetting
        self.pacing.on_command(command, self.sent)


def main() -> None:
    """Entry point of the executable ``plant``."""
    sys.exit(run_node(PlantNode))
