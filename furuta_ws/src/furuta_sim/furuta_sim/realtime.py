"""Real time: samples at absolute deadlines of the steady clock."""

from __future__ import annotations

from time import monotonic_ns
from typing import TYPE_CHECKING, NamedTuple

from rclpy.clock import Clock, ClockType
from std_msgs.msg import MultiArrayDimension, MultiArrayLayout, UInt64MultiArray

from furuta_ros.messages import NANOSECONDS
from furuta_ros.node import WARNING_PERIOD
from furuta_ros.topics import TIMING
from furuta_sim.histogram import Histogram

if TYPE_CHECKING:
    from furuta_sim.plant_node import PlantNode


# Bins of the published histograms, and how often they are published [s].
WIDTH, BINS = 20, 250  # [µs]
PUBLISHED_EVERY = 1.0


class TimingCounts(NamedTuple):
    """Counts since the start of the motion."""

    samples: int = 0  # measurements published
    on_time: int = 0  # of these, commanded before the next one
    overruns: int = 0  # deadlines without measurement because the plant's process came late
    timeouts: int = 0  # samples driven with 0 V because the command was too old


class RealTime:
    """Drives a :class:`Plant` by a timer.

    A sample without a new command keeps the last one; once that is older than
    ``command_timeout``, the rig gets 0 V until the next arrives. If the process comes late by
    more than half a sample it waits for the next deadline, so that measurements keep their
    distance; the rig moves on meanwhile, as a real one would.
    """

    def __init__(self, plant: PlantNode) -> None:
        self._plant = plant
        self._period = round(plant.parameters.plant.sample_time * NANOSECONDS)
        self._command = 0.0
        self._command_at = 0
        self._answered = False
        self.timing_counts = TimingCounts()
        self.latency, self.lateness = Histogram(), Histogram()
        self._published_at = 0
        self._timing = plant.publish_on(TIMING)
        # Stamps are ROS time, deadlines steady time: an adjusted clock moves no deadline.
        plant.start = plant.get_clock().now().nanoseconds
        self._first_deadline = monotonic_ns()
        plant.create_timer(
            plant.parameters.plant.sample_time,
            self._tick,
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )
        plant.create_timer(PUBLISHED_EVERY, self._publish_timing)

    def on_command(self, command: float) -> None:
        """Keep the command until the next one."""
        now = monotonic_ns()
        if self._published_at and not self._answered:
            self.latency.add(now - self._published_at)
        self._command, self._command_at, self._answered = command, now, True

    def _tick(self) -> None:
        plant = self._plant
        now = monotonic_ns()
        deadline, late = divmod(now - self._first_deadline, self._period)
        if plant.paused:
            # By whole periods: the timer's ticks come where they came before.
            self._first_deadline += (deadline - plant.sample) * self._period
            return
        if late > self._period // 2:
            return
        due = max(1, deadline - plant.sample)
        stale = now - self._command_at > plant.parameters.command_timeout * NANOSECONDS
        if not plant.held:
            self._count(due, stale)
        for _ in range(due):
            plant.move(0.0 if stale else self._command)
        self.lateness.add((due - 1) * self._period + late)
        self._answered = False
        self._published_at = monotonic_ns()
        plant.publish_sample()

    def _publish_timing(self) -> None:
        rows = [MultiArrayDimension(label="latency, lateness", size=2, stride=2 * BINS)]
        bins = MultiArrayDimension(label=f"bins of {WIDTH} us", size=BINS, stride=BINS)
        counts = self.latency.coarse(WIDTH, BINS) + self.lateness.coarse(WIDTH, BINS)
        self._timing.publish(
            UInt64MultiArray(layout=MultiArrayLayout(dim=[*rows, bins]), data=counts)
        )

    def _count(self, due: int, stale: bool) -> None:
        samples, on_time, overruns, timeouts = self.timing_counts
        self.timing_counts = TimingCounts(
            samples + 1,
            on_time + self._answered,
            overruns + due - 1,
            timeouts + due * stale,
        )
        if stale:
            self._plant.get_logger().warning(
                f"no command for {self._plant.parameters.command_timeout:g} s: 0 V",
                throttle_duration_sec=WARNING_PERIOD,
            )
