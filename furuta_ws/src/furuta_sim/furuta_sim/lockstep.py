"""Lock-step: the next sample starts when the command for this one has arrived.

A run then depends on the parameters and the seed alone. One message at a time passes around the
loop plant → estimator → (observer →) controller → plant. A message can be lost while a node is not
yet connected, at the start or after a restart, or while a topic has two publishers. The measurement
is then sent again. The plant continues when every sending of it has been answered, or when no
further command arrives, so that there are never two messages in the loop. The middleware can still
deliver a command seconds late: one that was sent before the sample began does not answer it.
"""

from time import monotonic, time_ns

from furuta_ros.discovery import clock_advice
from furuta_ros.loop_topics import missing_from_loop, publishers_of
from furuta_ros.simulated_clock import SimulatedClock
from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, JOINT_STATES, MEASUREMENT
from furuta_sim.paced_node import PacedNode

CHECK_PERIOD = 0.1  # [s] between checks of the loop
REPEAT_AFTER = 0.5  # [s] without a command until a lost measurement is sent again
# [s] without a command until it is sent again although the loop has the same nodes: a slow
# controller gets this time for a sample.
LOST_AFTER = 3.0
# [s] without a further command until the command to a repetition is applied. Longer than the time
# after which the controller takes no estimate for one of a repetition any more.
SETTLE_TIME = 2.0
WARN_AFTER = 4.0  # [s] without a command until a warning, and between warnings
# [s] from the first connection until the run starts although a topic has subscribers only.
INCOMPLETE_AFTER = 4.0


class LockStep:
    """Moves the plant when a command arrives."""

    def __init__(self, plant: PacedNode) -> None:
        self._plant = plant
        self._waiting = False  # for the command to the published sample
        self._unanswered = 0  # measurements of this sample without a command
        self._repeated = False
        self._late_possible = True  # a command to the previous sample, which was repeated
        self._late = 0  # commands that were sent before this sample began
        self._began = 0  # [ns since 1970], known when a late command is possible
        self._command: float | None = None  # received after a repetition, not yet applied
        self._seen = -1  # the sample of the last check
        self._publish_time = self._repeat_time = self._warning_time = monotonic()
        self._arrival_time = 0.0
        self._connected_since: float | None = None
        self._known_publishers: frozenset[bytes] = frozenset()
        self._clock = SimulatedClock(plant)
        plant.steady_timer(CHECK_PERIOD, self._check)
        plant.on_change = self._resume

    def on_command(self, command: float) -> None:
        """Apply the command for the published sample; ignore any other."""
        if not self._waiting:
            return
        if self._late_possible and 0 < self._plant.message_age.sent < self._began:
            self._late += 1
            return
        self._unanswered -= 1
        if self._unanswered == 0:
            self._step(command)
        else:
            self._command, self._arrival_time = command, monotonic()

    def _step(self, command: float) -> None:
        self._waiting = False
        self._command = None
        self._plant.move(command)
        if not self._plant.paused:
            self._publish()

    def _publish(self) -> None:
        self._waiting = True
        self._late_possible = self._repeated or self._plant.sample == 0
        self._late = 0
        if self._late_possible:
            self._began = time_ns()
        self._repeated = False
        self._unanswered = 1
        self._clock.advance(self._plant.stamp)
        self._plant.publish_sample()

    def _resume(self) -> None:
        """Continue at once when ``run_until`` is raised."""
        if not self._waiting and not self._plant.paused and self._plant.sample > 0:
            self._publish()

    def _check(self) -> None:
        """Start when the graph is connected; while waiting, recover a lost message."""
        now = monotonic()
        if self._seen != self._plant.sample:
            self._seen = self._plant.sample
            self._publish_time = self._repeat_time = now
        if self._waiting:
            self._recover(now)
        elif self._plant.paused:
            self._warning_time = now
        elif self._may_start(now):
            self._known_publishers = self._publishers()
            self._publish_time = self._repeat_time = now
            self._publish()
        self._clock.repeat()
        if now - max(self._publish_time, self._warning_time) >= WARN_AFTER:
            self._warning_time = now
            self._warn()

    def _recover(self, now: float) -> None:
        if self._command is not None:
            if now - self._arrival_time >= SETTLE_TIME:
                self._step(self._command)
        elif now - self._repeat_time >= REPEAT_AFTER:
            self._repeat_if_lost(now)

    def _repeat_if_lost(self, now: float) -> None:
        """Repeat the measurement if a node has joined or left, or the answer takes too long."""
        publishers = self._publishers()
        changed = publishers != self._known_publishers
        late = now - self._publish_time >= LOST_AFTER
        if self._repeated or self._plant.sample == 0 or changed or late:
            self._known_publishers = publishers
            self._repeated = True
            self._repeat_time = now
            self._unanswered += 1
            self._plant.repeat_measurement()

    def _connected(self) -> bool:
        plant = self._plant
        return (
            plant.count_subscribers(plant.resolve_topic_name(MEASUREMENT.name)) > 0
            and plant.count_publishers(plant.resolve_topic_name(COMMAND.name)) > 0
        )

    def _may_start(self, now: float) -> bool:
        """Whether the loop is complete; a recorder may wait for a topic that nobody publishes.

        A node that joins later would get some of the repeated messages only.
        """
        if not self._connected():
            self._connected_since = None
            return False
        if self._connected_since is None:
            self._connected_since = now
        return self._complete() or now - self._connected_since >= INCOMPLETE_AFTER

    def _complete(self) -> bool:
        """Whether all topics between the nodes that have subscribers have publishers."""
        plant = self._plant
        topics = (JOINT_STATES, FRICTION_ESTIMATE)
        names = [plant.resolve_topic_name(topic.name) for topic in topics]
        return all(plant.count_publishers(n) or not plant.count_subscribers(n) for n in names)

    def _publishers(self) -> frozenset[bytes]:
        """Identities of all publishers in the loop."""
        return frozenset(
            publisher.identity
            for topic in (MEASUREMENT, JOINT_STATES, FRICTION_ESTIMATE, COMMAND)
            for publisher in publishers_of(self._plant, topic)
        )

    def _warn(self) -> None:
        reason = "".join(f"; {clause}" for clause in missing_from_loop(self._plant))
        if self._late:
            reason += f"; ignored {self._late} that were sent before this sample began"
            reason += clock_advice()
        text = f"waiting for the command to sample {self._plant.sample}{reason}"
        # Without a reason a node is compiling, or the machine is busy.
        log = self._plant.get_logger()
        log.warning(text) if reason else log.info(text)
