"""Lock-step: the next sample starts when the command for this one has arrived.

A run then depends on the parameters and the seed alone. One message at a time passes around the
loop plant → estimator → (observer →) controller → plant. One can be lost while a node is not yet
connected, at the start or after a restart. The measurement is then sent again, and every node sends
its last answer again. Of the commands to a repetition the last one is applied, once no other has
come for a while, so that there are never two messages in the loop. The middleware can deliver a
command seconds late: one that was sent before its measurement is ignored.
"""

from time import monotonic, time_ns

from furuta_ros.middleware import clock_advice
from furuta_ros.simulated_clock import SimulatedClock
from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, JOINT_STATES, MEASUREMENT, Topic
from furuta_sim.simulated_plant import SimulatedPlant

CHECK_PERIOD = 0.1  # [s] between checks of the loop
REPEAT_AFTER = 1.0  # [s] without a command until the measurement is sent again
SETTLE_TIME = 1.0  # [s] without a further command until the one to a repetition is applied
WARN_AFTER = 4.0  # [s] without a command until a warning, and between warnings
# [s] from the first connection until the run starts although a topic has subscribers only.
INCOMPLETE_AFTER = 4.0


class LockStep:
    """Moves the plant when a command arrives."""

    def __init__(self, plant: SimulatedPlant) -> None:
        self._plant = plant
        self._is_waiting = self._is_repeated = False
        self._began = 0  # when the measurement was sent last [ns since 1970]
        self._late = 0  # commands to this sample that were sent before
        self._command: float | None = None  # to a repetition, not yet applied
        self._seen = -1  # the sample of the last check
        self._changed_at = self._warned_at = self._connected_at = monotonic()
        self._clock = SimulatedClock(plant)
        plant.steady_timer(CHECK_PERIOD, self._check)

    def on_command(self, command: float, sent: int) -> None:
        """Apply the command to the published sample; ignore any other.

        ``sent`` is when the command was sent [ns since 1970], 0 if not known.
        """
        if not self._is_waiting:
            return
        if 0 < sent < self._began:
            self._late += 1
        elif self._is_repeated:
            self._command, self._changed_at = command, monotonic()
        else:
            self._step(command)

    def resume(self) -> None:
        """Continue at once when ``run_until`` is raised."""
        if not self._is_waiting and not self._plant.paused and self._plant.sample > 0:
            self._publish()

    def _step(self, command: float) -> None:
        self._is_waiting = False
        self._plant.move(command)
        if not self._plant.paused:
            self._publish()

    def _publish(self) -> None:
        self._is_waiting, self._is_repeated, self._command = True, False, None
        self._late = 0
        self._clock.advance(self._plant.stamp)
        self._began = time_ns()
        self._plant.publish_sample()

    def _repeat(self) -> None:
        self._is_repeated = True
        self._began = time_ns()
        self._plant.repeat_measurement()

    def _check(self) -> None:
        """Start when the graph is connected; while waiting, recover a lost message."""
        now = monotonic()
        if self._seen != self._plant.sample:
            self._seen, self._changed_at, self._warned_at = self._plant.sample, now, now
        if self._is_waiting:
            self._recover(now)
        elif self._plant.paused:
            self._warned_at = now
        elif self._may_start(now):
            self._changed_at = now
            self._publish()
        self._clock.repeat()
        if now - self._warned_at >= WARN_AFTER:
            self._warned_at = now
            self._warn()

    def _recover(self, now: float) -> None:
        """Apply the command to a repetition if there is one, or else send another repetition."""
        unchanged = now - self._changed_at
        if self._command is not None and unchanged >= SETTLE_TIME:
            self._step(self._command)
        elif self._command is None and unchanged >= REPEAT_AFTER:
            self._changed_at = now
            self._repeat()

    def _may_start(self, now: float) -> bool:
        """Whether the loop is complete; a recorder may wait for a topic that nobody publishes."""
        if not (self._subscribers(MEASUREMENT) and self._publishers(COMMAND)):
            self._connected_at = now
            return False
        between = (JOINT_STATES, FRICTION_ESTIMATE)
        complete = all(self._publishers(t) or not self._subscribers(t) for t in between)
        return complete or now - self._connected_at >= INCOMPLETE_AFTER

    def _publishers(self, topic: Topic) -> int:
        return self._plant.count_publishers(self._plant.resolve_topic_name(topic.name))

    def _subscribers(self, topic: Topic) -> int:
        return self._plant.count_subscribers(self._plant.resolve_topic_name(topic.name))

    def _warn(self) -> None:
        plant = self._plant
        reasons = [] if self._subscribers(MEASUREMENT) else [("subscribes to", MEASUREMENT)]
        for topic in (JOINT_STATES, FRICTION_ESTIMATE, COMMAND):
            if not self._publishers(topic):
                reasons.append(("publishes", topic))
        text = f"waiting for the command to sample {plant.sample}" + "".join(
            f"; no node {does} {plant.resolve_topic_name(topic.name)}" for does, topic in reasons
        )
        if self._late:
            text += f"; ignored {self._late} that were sent before this sample began"
            text += clock_advice()
        # Without a reason a node is compiling, or the machine is busy.
        log = plant.get_logger()
        log.warning(text) if reasons or self._late else log.info(text)
