"""Two publishers of a topic and a subscriber that must accept one of them, as a system to explore.

``OnePublisher`` is the class that the nodes run. The first publisher sends one message at a time,
the second one bursts of which some are lost. Either starts and ends at any time.
"""

from collections.abc import Iterator
from typing import Any

from proofs.explorer import shallow

from furuta_ros import one_publisher
from furuta_ros.one_publisher import NONE_YET, OnePublisher, TopicPublisher

FIRST, SECOND = TopicPublisher(b"1", "/first"), TopicPublisher(b"2", "/second")
TICK = one_publisher.LOOKUP_PERIOD
MARGIN = 3  # in place of 100; between two messages of a burst fewer are lost
HIGHEST = 10  # sequence number, at which a publisher has sent all
IN_QUEUE = 2
OLDEST = 3  # ticks
TICKS = 6  # none passes while a message is on the way


class Publishers:
    """A state: who is there, what is on the way, and whom the subscriber accepts."""

    def __init__(self) -> None:
        self.alive: tuple[TopicPublisher, ...] = (FIRST,)
        self.sent = {FIRST: 4, SECOND: 0}  # the first one has run for a while
        self.queue: tuple[tuple[TopicPublisher, int], ...] = ()
        self.ticks = 0
        self.losses = 1
        self.violation = ""
        self.one = OnePublisher("command", lambda: (), lambda text: None, lambda: 0.0)
        self._attach()
        self.one._next, self.one._accepted = 5, FIRST

    done = True  # silence is allowed

    def _attach(self) -> None:
        self.one._look_up = lambda: self.alive
        self.one._now = lambda: self.ticks * TICK * 1.001

    def publish(self, who: TopicPublisher, skipped: int = 0) -> None:
        """Send a message, after some that are lost at once."""
        self.sent[who] += 1 + skipped
        self.queue += ((who, self.sent[who]),)

    def receive(self) -> None:
        """Deliver the oldest message."""
        (who, number), *rest = self.queue
        self.queue = tuple(rest)
        if self.one.accepts(number) and who is SECOND and FIRST in self.alive:
            self.violation = f"number {number} of the second publisher is accepted"

    def end(self, who: TopicPublisher) -> None:
        """A publisher ends."""
        self.alive = tuple(publisher for publisher in self.alive if publisher is not who)

    def copy(self) -> "Publishers":
        """An independent copy."""
        new: Publishers = shallow(self)
        new.sent, new.one = dict(self.sent), shallow(self.one)
        new._attach()
        return new

    def key(self) -> Any:
        """What determines how it goes on."""
        one, now = self.one, self.one._now()
        since = [now - t for t in (one._lookup_time, one._several_until)]
        return (
            tuple(min(OLDEST, t // TICK) for t in since),
            (self.alive, tuple(self.sent.values()), self.queue, self.losses, self.violation),
            (one._next, one._accepted, one._lower_than, tuple(one._listed)),
        )


def steps(state: Publishers) -> Iterator[tuple[str, Publishers]]:
    """All that can happen next."""

    def after(name: str, *arguments: Any) -> tuple[str, Publishers]:
        new = state.copy()
        getattr(new, name)(*arguments)
        return " ".join(str(part) for part in (name, *arguments)), new

    for who in state.alive:
        for skipped in range(MARGIN if who is SECOND else 1):
            if state.sent[who] + skipped < HIGHEST and len(state.queue) < IN_QUEUE:
                yield after("publish", who, skipped)
        # While nobody is accepted, a message whose publisher was never seen could be anybody's.
        one, on_the_way = state.one, any(sender is SECOND for sender, _ in state.queue)
        unseen = on_the_way and one._next == NONE_YET and SECOND not in one._listed
        if SECOND in state.alive and not unseen:
            yield after("end", who)
    if state.queue:
        yield after("receive")
        if state.losses and state.queue[0][0] is FIRST:
            name, new = "lose", state.copy()
            new.queue, new.losses = new.queue[1:], new.losses - 1
            yield name, new
    if SECOND not in state.alive and state.sent[SECOND] == 0:
        name, new = "the second starts", state.copy()
        new.alive += (SECOND,)
        yield name, new
    if state.ticks < TICKS and not state.queue:
        name, new = "time passes", state.copy()
        new.ticks += 1
        yield name, new
