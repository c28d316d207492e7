"""Real time: a timer starts samples at absolute deadlines of the steady clock."""

from __future__ import annotations

from array import array
from time import monotonic_ns
from typing import NamedTuple

import numpy as np
from std_msgs.msg import MultiArrayDimension, MultiArrayLayout, UInt64MultiArray

from furuta_ros.node import QOS, RARELY
from furuta_ros.simulated_clock import reject_simulated_time
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import TIMING
from furuta_sim.simulated_plant import SimulatedPlant

# Histograms count in bins of 1 µs. The last one [µs] also counts all longer durations.
LAST_BIN = 20_000
MICROSECOND = 1000  # [ns]
PERCENTILES = (50.0, 90.0, 99.0, 99.9)
# Width [µs] and number of the bins of the published ones.
BIN_WIDTH, BINS = 20, 250
# Time between two publications [s].
TIMING_PERIOD = 1.0
REAL_TIME = "with clock realtime, stamps are the system's time; use clock lockstep to simulate time"


class Histogram:
    """Counts durations, in constant memory."""

    def __init__(self) -> None:
        self._counts = array("Q", bytes(8 * (LAST_BIN + 1)))
        # The same memory as an array. Counting one duration is faster without numpy.
        self.counts = np.frombuffer(self._counts, dtype=np.uint64)
        self.largest = 0  # [ns]

    def add(self, duration: int) -> None:
        """Count a duration [ns]; a negative one counts as 0."""
        self.largest = max(self.largest, duration)
        self._counts[min(max(duration, 0) // MICROSECOND, LAST_BIN)] += 1

    @property
    def total(self) -> int:
        """Number of durations counted."""
        return int(self.counts.sum())

    def percentile(self, percent: float) -> float:
        """The duration [s] that ``percent`` of the durations did not exceed; NaN without any."""
        if not self.total:
            return float("nan")
        rank = max(1, int(np.ceil(percent / 100.0 * self.total)))
        bin_ = int(np.searchsorted(np.cumsum(self.counts), rank))
        return self.largest * 1e-9 if bin_ == LAST_BIN else (bin_ + 1) * 1e-6

    def coarse(self, width: int, bins: int) -> array[int]:
        """Counts in ``bins`` bins of ``width`` [µs]; the last one also counts longer durations."""
        return array("Q", np.add.reduceat(self.counts, np.arange(0, width * bins, width)).tobytes())

    def summary(self) -> str:
        """The percentiles as text."""
        parts = [
            f"{percent:g} % within {self.percentile(percent) * 1e6:.0f} µs"
            for percent in PERCENTILES
        ]
        return ", ".join([*parts, f"at most {self.largest * 1e-3:.0f} µs"])


class TimingCounts(NamedTuple):
    """Counts since the rig was released from its initial state."""

    samples: int = 0  # measurements published
    on_time: int = 0  # of these, answered by a command before the next one
    overruns: int = 0  # deadlines without measurement because the plant's process was late
    timeouts: int = 0  # samples at 0 V because the command was too old


class RealTime:
    """Moves the plant by a timer.

    A sample without a new command uses the last one. When that is older than ``command_timeout``,
    the rig gets 0 V until the next command arrives. If the process is late by more than half a
    sample, it waits for the next deadline, so that measurements stay evenly spaced. The rig is
    then moved over all samples that are due, as a real rig would have moved.
    """

    def __init__(self, plant: SimulatedPlant) -> None:
        reject_simulated_time(plant, REAL_TIME)
        self._plant = plant
        self._command = 0.0
        self._command_time = 0
        self._answered = False
        self.timing_counts = TimingCounts()
        self.latency, self.lateness = Histogram(), Histogram()
        self._publish_time = 0
        self._timing = plant.create_publisher(TIMING.message, TIMING.name, QOS)
        # Stamps are in ROS time, deadlines in steady time: adjusting the clock moves no deadline.
        plant.start = plant.get_clock().now().nanoseconds
        self._first_deadline = monotonic_ns()
        plant.steady_timer(plant.parameters.plant.sample_time, self._tick)
        plant.steady_timer(TIMING_PERIOD, self._publish_timing)

    def on_command(self, command: float, sent: int) -> None:
        """Keep the command until the next one."""
        now = monotonic_ns()
        if self._publish_time and not self._answered:
            self.latency.add(now - self._publish_time)
        self._command, self._command_time, self._answered = command, now, True

    def resume(self) -> None:
        """Nothing to do when ``run_until`` is raised: the timer goes on."""

    def summary(self) -> list[str]:
        """How many samples had their command in time, latency and lateness, in lines."""
        count = self.timing_counts
        share = count.on_time / max(1, count.samples)
        return [
            f"{share:.2%} of {count.samples} samples had their command before the next one; "
            f"{count.overruns} overruns, {count.timeouts} samples at 0 V because the command was "
            "too old",
            f"latency   {self.latency.summary()}",
            f"lateness  {self.lateness.summary()}",
        ]

    def _tick(self) -> None:
        plant = self._plant
        now = monotonic_ns()
        deadline, late = divmod(now - self._first_deadline, plant.period)
        if plant.paused:
            # Shift by whole periods: the timer keeps its phase. The command does not grow older.
            shift = (deadline - plant.sample) * plant.period
            self._first_deadline += shift
            self._command_time += shift
            return
        # After a reset the next sample is not due yet.
        if late > plant.period // 2 or deadline < plant.sample:
            return
        due_samples = max(1, deadline - plant.sample)
        stale = now - self._command_time > plant.parameters.command_timeout * NANOSECONDS
        if not plant.held:
            self._count(due_samples, stale)
        for _ in range(due_samples):
            plant.move(0.0 if stale else self._command)
        self.lateness.add((due_samples - 1) * plant.period + late)
        self._answered = False
        self._publish_time = monotonic_ns()
        plant.publish_sample()

    def _publish_timing(self) -> None:
        rows = [MultiArrayDimension(label="latency, lateness", size=2, stride=2 * BINS)]
        bins = MultiArrayDimension(label=f"bins of {BIN_WIDTH} us", size=BINS, stride=BINS)
        counts = self.latency.coarse(BIN_WIDTH, BINS) + self.lateness.coarse(BIN_WIDTH, BINS)
        self._timing.publish(
            UInt64MultiArray(layout=MultiArrayLayout(dim=[*rows, bins]), data=counts)
        )

    def _count(self, due_samples: int, stale: bool) -> None:
        samples, on_time, overruns, timeouts = self.timing_counts
        self.timing_counts = TimingCounts(
            samples + 1,
            on_time + self._answered,
            overruns + due_samples - 1,
            timeouts + due_samples * stale,
        )
        if stale:
            self._plant.warn(
                "no command",
                f"no command for {self._plant.parameters.command_timeout:g} s: the motor gets 0 V",
                RARELY,
            )
