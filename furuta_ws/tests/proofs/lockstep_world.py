"""The lock-step loop as a system to explore: the nodes' own code, and a middleware that misbehaves.

``LockStep``, ``EstimateMatching`` and the controller's answers are the classes that the nodes run.
Around them stand four queues and a clock. A step is: a message is received or lost, half a second
passes, a node is restarted, or the plant is reset.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple
from unittest.mock import patch

from proofs.explorer import shallow

from furuta_control.controller_node import ControllerNode
from furuta_control.estimate_matching import EstimateMatching
from furuta_ros.wire import ANEW, CONTINUES, REPEATED
from furuta_sim import lockstep
from furuta_sim.lockstep import LockStep

SECOND = 1_000_000_000
TICK = SECOND // 2  # [ns]
EVENT = 1000  # [ns] between two events
# Ticks after which an age makes no more difference: longer than every time in the protocol.
OLDEST = 9
QUEUES = ("measurement", "state to observer", "state", "estimate", "command")
RESET_GAP = 10  # samples that a reset takes
LATE_COMMANDS = 1  # that may be on the way for any time
NODES = ("estimator", "friction_observer", "controller")


class Bounds(NamedTuple):
    """How much may go wrong in a run of so many samples.

    ``early`` counts half seconds that pass although messages other than commands are on the way.
    """

    samples: int
    losses: int = 0
    restarts: int = 0
    early: int = 0
    resets: int = 0


class Controller:
    """The controller without ROS: its answers to states and estimates."""

    _do = ControllerNode._do
    taken = ControllerNode.taken

    def __init__(self, world: "World") -> None:
        self.world = world
        self.message_age = world.message_age
        self._matching = EstimateMatching(10)
        self._memory, self._memory_before = [0], [0]
        self.sample = -1
        self.command = (-1, -1)

    def _compute(self, friction: float) -> None:
        self.command = (self.sample, int(friction))
        self.publish_answer()

    def _compute_without_estimate(self) -> None:
        self._compute(self._matching.friction)

    def publish_answer(self) -> None:
        """Send the last command."""
        self.world.send("command", self.command)

    def on_state(self, sample: int) -> None:
        """Receive a state."""
        follows = sample == self.sample + 1
        kind = REPEATED if sample == self.sample else CONTINUES if follows else ANEW
        self.sample = sample
        self.taken(kind)

    def on_estimate(self, sample: int) -> None:
        """Receive an estimate."""
        self._do(self._matching.estimate(float(sample), self.message_age.sent))


class Age:
    """When the message that is being received was sent [ns]."""

    sent = 0


class World:
    """A state of the loop; it also plays the plant's node for ``LockStep``."""

    def __init__(self, bounds: Bounds) -> None:
        self.bounds, self.budget = bounds, bounds[1:]
        self.now = SECOND
        self.message_age = Age()
        self.queues: dict[str, tuple[Any, ...]] = dict.fromkeys(QUEUES, ())
        self.estimator = self.observer = -1  # newest sample of each
        self.generation = 0  # of the nodes that publish
        self.sample, self.held, self.resetting = 0, True, False
        self.violation = ""
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
        self.resetting = False
        self.repeat_measurement()

    def repeat_measurement(self) -> None:
        """Send it again."""
        self.send("measurement", self.sample)

    def move(self, command: tuple[int, int]) -> None:
        """Apply a command, which must be that of this sample."""
        if not self.held and command != (self.sample, self.sample):
            self.violation = f"sample {self.sample} moves by the command to {command}"
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
        self.message_age.sent = sent
        if queue == "measurement":
            self.estimator = content
            self.send("state to observer", content)
            self.send("state", content)
        elif queue == "state to observer":
            self.observer = content
            self.send("estimate", content)
        elif queue == "state":
            self.controller.on_state(content)
        elif queue == "estimate":
            self.controller.on_estimate(content)
        else:
            self.held = self.resetting
            self.lockstep.on_command(content)

    def restart(self, node: str) -> None:
        """A node is killed and started again: what it had received is gone."""
        self.generation += 1
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
        new.message_age, new.queues = Age(), dict(self.queues)
        new.controller, new.lockstep = shallow(self.controller), shallow(self.lockstep)
        new.controller.world, new.controller.message_age = new, new.message_age
        new.controller._matching = shallow(self.controller._matching)
        new.lockstep._plant = new
        return new

    def key(self) -> Any:
        """The state, with times by their order and by the half seconds since."""
        step, match = self.lockstep, self.controller._matching
        early = match._early
        times = [
            *(sent for queue in QUEUES for _, sent in self.queues[queue]),
            *(match._sent, match._sent_last, early[1] if early else 0, step._began),
            *(round(t * SECOND) for t in (step._publish_time, step._repeat_time)),
            round(step._arrival_time * SECOND),
        ]
        order = sorted(set(times))
        return (
            tuple((min(OLDEST, (self.now - t) // TICK), order.index(t)) for t in times),
            tuple(tuple(content for content, _ in self.queues[queue]) for queue in QUEUES),
            (self.sample, self.held, self.resetting, self.generation, self.budget),
            (self.estimator, self.observer, self.controller.sample, self.controller.command),
            (match.friction, match.missed, match._expected, match._stepped, match._repetitions),
            (early and early[0], match._any_state, match._uncertain, match._previous_uncertain),
            (step._waiting, step._unanswered, step._repeated, step._late_possible, step._command),
            (step._known_publishers, step._seen, match.refused_in_a_row, self.violation),
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
    """``LockStep`` with the world's clock, and publishers that change when a node is restarted."""
    CLOCK.world = None
    names = {"monotonic": CLOCK.monotonic, "time_ns": CLOCK.time_ns, "SimulatedClock": NoClock}
    with (
        patch.multiple(lockstep, **names),
        patch.object(LockStep, "_publishers", lambda step: frozenset({step._plant.generation})),
        patch.object(LockStep, "_warn", lambda step: None),
    ):
        yield
