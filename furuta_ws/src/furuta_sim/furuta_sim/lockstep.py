"""Lock-step time: the next sample starts when the command for this one has arrived.

The run is then a function of parameters and seed alone. One message at a time goes round the
ring plant → estimator → (observer →) controller → plant. It can get lost only where a node was
not yet there, at the start or after a restart; then the measurement is sent again, and the
first command is taken once no further one arrives, so that never two go round.
"""

from __future__ import annotations

from time import monotonic
from typing import TYPE_CHECKING

from rclpy.clock import Clock, ClockType

from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, JOINT_STATES, MEASUREMENT

if TYPE_CHECKING:
    from furuta_sim.plant_node import PlantNode

LOOK = 0.1  # [s] between looks at the state of the ring
REPEAT = 0.5  # [s] without command after which a lost measurement is sent again
QUIET = 0.3  # [s] without further commands after a repetition
COMPLAIN = 5.0  # [s] without command after which, and how often, the user is told


class LockStep:
    """Drives a :class:`Plant` by the arrival of commands."""

    def __init__(self, plant: PlantNode) -> None:
        self._plant = plant
        self._waiting = False  # for the command to the published sample
        self._repeated = False
        self._command: float | None = None  # arrived after a repetition
        self._published_at = 0.0
        self._repeated_at = 0.0
        self._arrived_at = 0.0
        self._complained_at = 0.0
        self._ring: frozenset[bytes] = frozenset()
        plant.create_timer(LOOK, self._look, clock=Clock(clock_type=ClockType.STEADY_TIME))
        plant.on_change = self._resume

    def on_command(self, command: float) -> None:
        """Take the command for the published sample; any other is not for this time."""
        if not self._waiting:
            return
        if self._repeated:
            self._command, self._arrived_at = command, monotonic()
            return
        self._step(command)

    def _step(self, command: float) -> None:
        self._waiting = False
        self._plant.move(command)
        if not self._plant.paused:
            self._publish()

    def _publish(self) -> None:
        self._waiting = True
        self._repeated = False
        self._published_at = self._repeated_at = monotonic()
        self._plant.publish_sample()

    def _resume(self) -> None:
        """Go on at once when ``run_until`` is raised."""
        if not self._waiting and not self._plant.paused and self._plant.sample > 0:
            self._publish()

    def _look(self) -> None:
        """Start, and mend a broken ring."""
        if not self._waiting:
            if not self._plant.paused and self._complete():
                self._ring = self._publishers()
                self._publish()
            return
        now = monotonic()
        if self._command is not None:
            if now - self._arrived_at >= QUIET:
                command, self._command = self._command, None
                self._step(command)
        elif now - self._repeated_at >= REPEAT:
            self._repeated_at = now
            self._repeat_if_lost()
        if now - max(self._published_at, self._complained_at) >= COMPLAIN:
            self._complained_at = now
            self._complain()

    def _repeat_if_lost(self) -> None:
        ring = self._publishers()
        if self._repeated or self._plant.sample == 0 or ring != self._ring:
            self._ring = ring
            self._repeated = True
            self._plant.repeat_measurement()

    def _complete(self) -> bool:
        plant = self._plant
        return (
            plant.count_subscribers(plant.resolve_topic_name(MEASUREMENT.name)) > 0
            and plant.count_publishers(plant.resolve_topic_name(COMMAND.name)) > 0
        )

    def _publishers(self) -> frozenset[bytes]:
        """Identities of the publishers that make the ring."""
        return frozenset(
            bytes(endpoint.endpoint_gid)
            for topic in (JOINT_STATES, FRICTION_ESTIMATE, COMMAND)
            for endpoint in self._plant.get_publishers_info_by_topic(
                self._plant.resolve_topic_name(topic.name)
            )
        )

    def _complain(self) -> None:
        missing = [
            topic.name
            for topic in (JOINT_STATES, FRICTION_ESTIMATE, COMMAND)
            if self._plant.count_publishers(self._plant.resolve_topic_name(topic.name)) == 0
        ]
        nobody = f"; nobody publishes {', '.join(missing)}" if missing else ""
        self._plant.get_logger().warning(
            f"waiting for the command to sample {self._plant.sample}{nobody}"
        )
