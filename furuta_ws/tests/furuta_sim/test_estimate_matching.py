"""Matching of friction estimates to states, against a model of the loop's four queues."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from hypothesis import given, settings
from hypothesis import strategies as st

from furuta_control.estimate_matching import (
    SUSPICIOUS,
    Answer,
    EstimateMatching,
)
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import QOS
from furuta_sim import lockstep

SAMPLES = 6
SETTLE_TIME = round(lockstep.SETTLE_TIME * NANOSECONDS)
# A choice for every step of the loop: which of the possible things happens next.
CHOICES = st.lists(st.integers(0, 20), min_size=40, max_size=400)


@dataclass
class Link:
    """What is on the way between two nodes, in order; lost until they know each other."""

    known: bool = False
    messages: deque[tuple[int, int]] = field(default_factory=deque)

    def send(self, sample: int, time: int) -> None:
        """Put a message of a sample on the way."""
        if self.known:
            self.messages.append((sample, time))


class LockStepLoop:
    """Plant, observer and controller in lock-step, one event at a time.

    Nodes get to know each other at any time. The plant repeats a sample at any time until its
    command has come. It goes on when every sending has been answered, or when nothing is on the
    way (it waits long enough for that).
    """

    def __init__(self) -> None:
        self.states_to_observer, self.states_to_controller = Link(), Link()
        self.estimates, self.commands = Link(), Link()
        self.links = [
            self.states_to_observer,
            self.states_to_controller,
            self.estimates,
            self.commands,
        ]
        self.matching = EstimateMatching(QOS.depth)
        self.time = 0
        self.sample = 0
        self.unanswered = 0
        self.received: tuple[int, int] | None = None  # sample of command, sample of its estimate
        self.newest = -1  # state in the controller
        self.command = (-1, -1)
        self.used: list[tuple[int, int]] = []
        self.publish()

    def publish(self) -> None:
        """Send the sample, first or again; the estimator is part of the plant here."""
        self.unanswered += 1
        for link in (self.states_to_observer, self.states_to_controller):
            link.send(self.sample, self.time)

    def observe(self) -> None:
        """The observer receives a state and sends its estimate."""
        self.estimates.send(self.states_to_observer.messages.popleft()[0], self.time)

    def control_state(self) -> None:
        """The controller receives a state."""
        sample, time = self.states_to_controller.messages.popleft()
        if sample == self.newest:
            self.do(self.matching.repetition(time))
        else:
            self.newest = sample
            self.do(self.matching.state(time))

    def control_estimate(self) -> None:
        """The controller receives an estimate."""
        sample, time = self.estimates.messages.popleft()
        self.do(self.matching.estimate(float(sample), time))

    def do(self, answer: Answer) -> None:
        """Do what the matching says, as the node does."""
        if answer in (Answer.STEP, Answer.STEP_WITHOUT, Answer.CORRECT):
            self.command = (self.newest, int(self.matching.friction))
        if answer is not Answer.NONE:
            self.commands.send(*self.command)

    def take_command(self) -> None:
        """The plant receives a command."""
        self.received = self.commands.messages.popleft()
        self.unanswered -= 1
        if self.unanswered == 0:
            self.go_on()

    def settle(self) -> None:
        """Go on because nothing has come for a long time."""
        self.time += SETTLE_TIME
        self.go_on()

    def go_on(self) -> None:
        """Apply the command and send the next sample."""
        assert self.received is not None
        self.used.append(self.received)
        self.received, self.unanswered = None, 0
        self.sample += 1
        self.time += 1
        self.publish()

    def advance(self, choice: int) -> None:
        """Let one of the possible things happen."""
        self.time += 1
        moves = self.possible()
        moves[choice % len(moves)]()

    def possible(self) -> list[Callable[[], None]]:
        """What can happen next."""
        moves: list[Callable[[], None]] = []
        for link in self.links:
            if not link.known:
                moves.append(lambda link=link: setattr(link, "known", True))
        moves += [
            receive
            for link, receive in (
                (self.states_to_observer, self.observe),
                (self.states_to_controller, self.control_state),
                (self.estimates, self.control_estimate),
                (self.commands, self.take_command),
            )
            if link.messages
        ]
        if not any(link.messages for link in self.links):
            moves.append(self.publish if self.received is None else self.settle)
        elif self.received is None and self.unanswered < QOS.depth:
            moves.append(self.publish)
        return moves


@settings(max_examples=400, deadline=None)
@given(CHOICES)
def test_every_sample_gets_its_own_estimate(choices: list[int]) -> None:
    """Whatever is lost at the start, comes twice, or overtakes: command k is for state k."""
    loop = LockStepLoop()
    for choice in choices:
        loop.advance(choice)
        if len(loop.used) >= SAMPLES:
            break
    assert loop.used == [(k, k) for k in range(len(loop.used))]
    assert loop.matching.missed == 0


@settings(max_examples=100, deadline=None)
@given(CHOICES)
def test_the_loop_always_goes_on(choices: list[int]) -> None:
    """From any situation the loop comes to the next samples when nothing more is lost."""
    loop = LockStepLoop()
    for choice in choices:
        loop.advance(choice)
    reached = len(loop.used)
    for _ in range(1000):
        loop.advance(0)
        if len(loop.used) >= reached + SAMPLES:
            return
    raise AssertionError("the loop stands still")


def test_estimates_that_stay_older_than_their_states_are_told() -> None:
    """As with clocks of two computers that differ."""
    matching = EstimateMatching(QOS.depth)
    matching.state(sent=100)
    for k in range(SUSPICIOUS):
        assert not matching.suspicious
        assert matching.estimate(0.1, sent=50 + k) is Answer.NONE
        matching.repetition(sent=60 + k)
    assert matching.suspicious
    assert matching.estimate(0.1, sent=101) is Answer.STEP
    assert not matching.suspicious


def test_in_real_time_clocks_are_not_compared() -> None:
    """Nothing is repeated there: counting is enough, and clocks may differ a little."""
    matching = EstimateMatching(QOS.depth)
    matching.state(sent=100)
    assert matching.estimate(0.1, sent=101) is Answer.STEP
    matching.state(sent=200)
    assert matching.estimate(0.2, sent=201) is Answer.STEP
    matching.state(sent=300)
    assert matching.estimate(0.3, sent=290) is Answer.STEP
    assert matching.estimate(0.4, sent=390) is Answer.NONE
    assert matching.state(sent=400) is Answer.STEP
    assert matching.friction == 0.4


def test_late_estimates_are_lost_after_a_while() -> None:
    """A state waits again for its estimate once ten in a row were late and one has come."""
    matching = EstimateMatching(QOS.depth)
    assert matching.state(sent=1) is Answer.NONE
    for k in range(QOS.depth):
        assert matching.state(sent=2 + k) is Answer.STEP_WITHOUT
    assert matching.estimate(0.1, sent=50) is Answer.CORRECT
    assert matching.state(sent=51) is Answer.NONE
    assert matching.estimate(0.2, sent=52) is Answer.STEP
