"""The lock-step loop as a system to explore: the nodes' own code, and a middleware that misbehaves.

``LockStep`` and the controller's methods are those that the nodes run. Around them stand four
queues and a clock. A step is: a message is received or lost, half a second passes, a node is
restarted, or the plant is reset.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple
from unittest.mock import patch

from proofs.explorer import shallow

from furuta_control.controller_node import ControllerNode
from furuta_ros.messages import read_value
from furuta_ros.time_stamps import NEVER
from furuta_ros.wire import NO_SIGNALS, joint_state_bytes, value_bytes
from furuta_sim import lockstep
from furuta_sim.lockstep import LockStep

SECOND = 1_000_000_000
TICK = SECOND // 2  # [ns]
EVENT = 1000  # [ns] between two events
# Ticks after which an age makes no more difference: longer than every time in the protocol.
OLDEST = 4
QUEUES = ("measurement", "state to observer", "state", "estimate", "command")
PERIOD = SECOND // 50  # of the samples [ns]
RESET_GAP = 10  # samples that a reset takes
LATE_COMMANDS = 1  # that may be on the way for any time
NODES = ("estimator", "friction_observer", "controller")
# A command stands for the sample and the estimate that it was computed from: this times the first
# plus the second.
CODE = 1000


class Bounds(NamedTuple):
    """How much may go wrong in a run of so many samples.

    ``early`` counts half seconds that pass although messages other than commands are on the way.
    """

    samples: int
    losses: int = 0
    restarts: int = 0
    early: int = 0
    resets: int = 0


class Controller(ControllerNode):
    """The controller's node without ROS and without arithmetic."""

    def __init__(self, world: "World") -> None:
        self.world = world
        self._x, self._memory, self._controller = NO_SIGNALS, None, None
        self._stamp, self._command = NEVER, 0.0
        self._friction, self._friction_stamp, self._timeout = 0.0, NEVER, 0.0
        self._is_estimated, self._is_applied = True, True
        self._answered_stamp, self._sample_time = NEVER, PERIOD
        self.missed_estimates = self._active_mode = 0

    def _step(self, memory: Any, x: Any, friction: float, *others: Any) -> tuple[float, int]:
        return CODE * self._stamp / PERIOD + friction, 0

    def warn(self, *about: Any, **named: Any) -> bool:
        """Log nothing."""
        return True

    def time_is_simulated(self) -> bool:
        """It is, in lock-step."""
        return True

    @property
    def _publisher(self) -> Any:
        return self

    def publish(self, data: bytes, stamp: int) -> None:
        """Send the last command."""
        self.world.send("command", read_value(data))

    def key(self) -> Any:
        """What determines how it goes on."""
        answered = self._answered_stamp == NEVER, self._answered_stamp == self._stamp
        flags = self._is_estimated, *answered
        return self._stamp, self._command, self._friction, self._friction_stamp, flags


class World:
    """A state of the loop; it also plays the plant's node for ``LockStep``."""

    def __init__(self, bounds: Bounds) -> None:
        self.bounds, self.budget = bounds, bounds[1:]
        self.now = SECOND
        self.queues: dict[str, tuple[Any, ...]] = dict.fromkeys(QUEUES, ())
        self.estimator = self.observer = -1  # newest sample of each
        self.sample, self.held, self.resetting, self.message = 0, True, False, 0
        self.problem = ""
        self.controller = Controller(self)
        self.lockstep = LockStep(self)
        self.lockstep._publish()

    @property
    def done(self) -> bool:
        """Whether all samples have their commands."""
        resets = self.bounds.resets - self.budget[3]
        return self.sample >= self.bounds.samples + RESET_GAP * resets

    # What LockStep asks of the plant's node.
    paused = property(lambda self: self.done)
    stamp = property(lambda self: self.sample)

    def steady_timer(self, period: float, call: Any) -> None:
        """The world calls the timer itself."""

    def publish_sample(self) -> None:
        """Send the measurement of a new sample."""
        self.resetting, self.message = False, self.sample
        self.repeat_measurement()

    def repeat_measurement(self) -> None:
        """Send it again."""
        self.send("measurement", self.message)

    def move(self, command: float) -> None:
        """Apply a command, which must be that of this sample."""
        if not self.held and command != CODE * self.sample + self.sample:
            self.problem = f"sample {self.sample} moves by the command to {command / CODE}"
        self.sample += 1

    # What the middleware does.
    def send(self, queue: str, content: Any) -> None:
        """Put a message on the way."""
        self.now += EVENT
        self.queues[queue] += ((content, self.now),)

    def receive(self, queue: str) -> None:
        """Deliver the oldest message."""
        (content, sent), *rest = self.queues[queue]
        self.queues[queue] = tuple(rest)
        self.now += EVENT
        if queue == "measurement":
            self.estimator = content
            self.send("state to observer", content)
            self.send("state", content)
        elif queue == "state to observer":
            self.observer = content
            self.send("estimate", content)
        elif queue == "state":
            self.controller.on_state(joint_state_bytes(content * PERIOD, NO_SIGNALS))
        elif queue == "estimate":
            self.controller.on_friction(value_bytes(content))
        else:
            self.held = self.resetting
            self.lockstep.on_command(content, sent)

    def restart(self, node: str) -> None:
        """A node is killed and started again: what it had received is gone."""
        if node == "controller":
            self.controller = Controller(self)
        inputs = {"estimator": (0,), "friction_observer": (1,), "controller": (2, 3)}
        for queue in (QUEUES[k] for k in inputs[node]):
            self.queues[queue] = ()

    def pass_time(self) -> None:
        """Half a second passes."""
        self.now += TICK
        self.lockstep._check()

    def reset(self) -> None:
        """Reset the plant."""
        self.held = self.resetting = True
        self.sample += RESET_GAP

    def copy(self) -> "World":
        """An independent copy."""
        new: World = shallow(self)
        new.queues = dict(self.queues)
        new.controller, new.lockstep = shallow(self.controller), shallow(self.lockstep)
        new.controller.world = new.lockstep._plant = new
        return new

    def key(self) -> Any:
        """The state, with times by their order and by the half seconds since."""
        step = self.lockstep
        times = [
            *(sent for queue in QUEUES for _, sent in self.queues[queue]),
            *(step._began, round(step._changed_at * SECOND)),
        ]
        order = sorted(set(times))
        return (
            tuple((min(OLDEST, (self.now - t) // TICK), order.index(t)) for t in times),
            tuple(tuple(content for content, _ in self.queues[queue]) for queue in QUEUES),
            (self.sample, self.held, self.resetting, self.message, self.budget, self.problem),
            (self.estimator, self.observer, self.controller.key()),
            (step._is_waiting, step._is_repeated, step._command, step._seen),
        )


def steps(world: World) -> Iterator[tuple[str, World]]:
    """All that can happen next.

    Half a second passes when nothing but commands is on the way, or ``early`` in spite of it.
    """
    losses, restarts, early, resets = world.budget
    waiting = [queue for queue in QUEUES if world.queues[queue]]
    for queue in waiting:
        yield f"receive {queue}", _after(world, lambda w, q=queue: w.receive(q))
        if losses:
            lost = _after(world, lambda w, q=queue: w.queues.update({q: w.queues[q][1:]}))
            yield f"lose {queue}", _spent(lost, 0)
    if world.done:
        return
    if len(world.queues["command"]) <= LATE_COMMANDS and waiting in ([], ["command"]):
        yield "half a second", _after(world, World.pass_time)
    elif early:
        yield "half a second, early", _spent(_after(world, World.pass_time), 2)
    if restarts:
        for node in NODES:
            yield f"restart {node}", _spent(_after(world, lambda w, n=node: w.restart(n)), 1)
    if resets:
        yield "reset", _spent(_after(world, World.reset), 3)


def _after(world: World, act: Any) -> World:
    new = world.copy()
    CLOCK.world = new
    act(new)
    return new


def _spent(world: World, what: int) -> World:
    world.budget = tuple(left - (k == what) for k, left in enumerate(world.budget))
    return world


class Clock:
    """The clock of the world that acts."""

    world: Any = None

    def time_ns(self) -> int:
        """Time [ns]."""
        return self.world.now if self.world else SECOND

    def monotonic(self) -> float:
        """Time [s]."""
        return self.time_ns() / SECOND


CLOCK = Clock()


class NoClock:
    """In place of the simulated clock: nothing is published."""

    def __init__(self, plant: Any) -> None: ...

    def advance(self, stamp: int) -> None:
        """Do nothing."""

    def repeat(self) -> None:
        """Do nothing."""


@contextmanager
def own_clock() -> Iterator[None]:
    """``LockStep`` with the world's clock."""
    CLOCK.world = None
    names = {"monotonic": CLOCK.monotonic, "time_ns": CLOCK.time_ns, "SimulatedClock": NoClock}
    with patch.multiple(lockstep, **names), patch.object(LockStep, "_warn", lambda step: None):
        yield
