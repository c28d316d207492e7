"""Accepts the messages of one publisher of a topic and rejects those of any other.

A loop works only if every topic has one publisher. A message does not say who published it, but it
has a sequence number: a publisher numbers its messages from 1. The message that continues the
accepted sequence is accepted. For any other message the publishers of the topic are looked up.
"""

from collections.abc import Callable, Sequence
from math import inf
from time import monotonic
from typing import NamedTuple

# Time [s] for which a list of several publishers is used before they are looked up again.
LOOKUP_PERIOD = 0.1
# Time [s] after which messages of a publisher that is no longer listed are no longer received.
SETTLING_TIME = 0.1
# A number this close to the expected one may be of either publisher.
MARGIN = 100
# Time [s] between two reports of the same publishers.
REPORT_PERIOD = 5.0
# No message has this number.
NONE_YET = 0


class TopicPublisher(NamedTuple):
    """A publisher of a topic: its identity in the middleware and the full name of its node."""

    identity: bytes
    node: str


class OnePublisher:
    """Decides which messages of a topic are accepted.

    The first publisher is accepted if it is the only one; another one replaces it only when it is
    no longer listed. While several are listed, only messages that continue its sequence are
    accepted. If the numbers of another one come close to it, the publishers cannot be told apart:
    then no message is accepted until one of them has been left for a moment.

    ``look_up`` lists the publishers of the topic; ``report`` gets a line for the user.
    ``rejected`` counts rejected messages.
    """

    def __init__(
        self,
        topic: str,
        look_up: Callable[[], Sequence[TopicPublisher]],
        report: Callable[[str], None],
        now: Callable[[], float] = monotonic,
    ) -> None:
        self._topic, self._look_up, self._report, self._now = topic, look_up, report, now
        self.rejected = 0
        self._next = NONE_YET  # sequence number that the next message must have
        self._accepted: TopicPublisher | None = None
        self._lower_than = NONE_YET  # `_next` at the last message with a lower number
        self._listed: Sequence[TopicPublisher] = ()
        self._lookup_time = self._several_until = self._report_time = -inf
        self._reported: Sequence[TopicPublisher] = ()

    def accepts(self, number: int | None) -> bool:
        """Whether to accept the message with this sequence number.

        Without a number, as in some middlewares, it is accepted from a sole publisher.
        """
        if number == self._next:
            self._next += 1
            return True
        self._update()
        if len(self._listed) == 1 and self._is_from_sole_publisher(number):
            self._next = NONE_YET if number is None else number + 1
            self._accepted = self._listed[0]
            return True
        if number is not None and self._next != NONE_YET and abs(number - self._next) <= MARGIN:
            self._next, self._several_until = NONE_YET, self._now()
        self.rejected += 1
        self._report_publishers()
        return False

    def check(self) -> None:
        """Report the publishers if there are several; call it from time to time."""
        self._update()
        if len(self._listed) > 1:
            self._report_publishers()

    def _update(self) -> None:
        """Look up the publishers, always anew if there was only one."""
        now, were_several = self._now(), len(self._listed) > 1
        if were_several and now - self._lookup_time < LOOKUP_PERIOD:
            return
        self._lookup_time, self._listed = now, self._look_up()
        if were_several or len(self._listed) > 1:
            self._several_until = now
        if self._accepted is not None:
            accepted = self._accepted.identity
            same = [publisher for publisher in self._listed if publisher.identity == accepted]
            # Its name may have been unknown so far.
            self._accepted = same[0] if same else None
            self._next = self._next if same else NONE_YET

    def _is_from_sole_publisher(self, number: int | None) -> bool:
        """Whether a message that does not continue the sequence is from the one listed."""
        if number is None:
            return True
        if self._now() - self._several_until < SETTLING_TIME:
            return False
        if self._next == NONE_YET or number > self._next:  # messages were lost
            return True
        # From one that is not listed any more, unless no message continues the sequence.
        if self._lower_than == self._next:
            self._next, self._several_until = NONE_YET, self._now()
        self._lower_than = self._next
        return False

    def _report_publishers(self) -> None:
        """Report who publishes, when that changes and again every ``REPORT_PERIOD``."""
        now, listed = self._now(), self._listed
        if listed == self._reported and now - self._report_time < REPORT_PERIOD:
            return
        self._reported, self._report_time = listed, now
        if len(listed) > 1:
            self._report(
                f"{len(listed)} nodes publish {self._topic}: {_names(listed)}; {self._rule} "
                f"({self.rejected} rejected so far)"
            )
        else:
            self._report(
                f"rejected a message on {self._topic}: it is not from {_names(listed)}, and its "
                "own publisher is not listed"
            )

    @property
    def _rule(self) -> str:
        """Which messages are accepted while there are several publishers."""
        if self._accepted is None or self._next == NONE_YET:
            return "no message is accepted until there is only one"
        name = self._accepted.node
        if sum(publisher.node == name for publisher in self._listed) > 1:
            return "only messages from the one that was first are accepted"
        return f"only messages from {name} are accepted"


def _names(listed: Sequence[TopicPublisher]) -> str:
    names = sorted(publisher.node for publisher in listed)
    killed = " (a killed node stays listed for up to 20 s)" if len(set(names)) < len(names) else ""
    return (" and ".join(names) or "any listed one") + killed
