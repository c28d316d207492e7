"""Accepts the messages of one publisher of a topic and rejects those of any other.

A loop works only if every topic has one publisher. A message does not say who published it, but it
has a sequence number: a publisher numbers its messages from 1. The message that continues the
sequence of the accepted publisher is accepted. For any other message the publishers of the topic
are looked up.
"""

from collections.abc import Callable, Sequence
from math import inf
from time import monotonic

from furuta_ros.publisher_report import PublisherReport, TopicPublisher

# Time [s] for which a sequence must be the only one received before it replaces the accepted one.
HANDOVER_TIME = 0.4
# Time [s] for which a list of several publishers is used before they are looked up again.
LOOKUP_PERIOD = 0.1
# No message has this number.
NONE_YET = 0


class OnePublisher:
    """Decides which messages of a topic are accepted.

    The first publisher is accepted if it is the only one. When it has ended, the next one replaces
    it. A killed node stays listed for up to 20 s: a publisher of the same node name replaces it
    earlier, after ``HANDOVER_TIME`` without a message of any other. Publishers whose sequence
    numbers coincide cannot be told apart: then no message is accepted until one of them is left.

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
        self._look_up, self._now = look_up, now
        self._report = PublisherReport(topic, report, now)
        self.rejected = 0
        self._next = NONE_YET  # sequence number that the next message must have
        self._accepted: TopicPublisher | None = None  # None while it is not known which one it is
        self._known: frozenset[bytes] = frozenset()  # all publishers listed when it was accepted
        self._candidate = _Candidate()
        self._listed: Sequence[TopicPublisher] = ()
        self._lookup_time = -inf

    def accepts(self, number: int | None) -> bool:
        """Whether to accept the message with this sequence number.

        Without a number, as in some middlewares, it is accepted from a sole publisher.
        """
        if number == self._next:
            self._next += 1
            return True
        self._update()
        if self._is_accepted(number):
            return True
        self.rejected += 1
        self._report.rejection(self._listed, self._rule, self.rejected)
        return False

    def check(self) -> None:
        """Report the publishers if there are several; call it from time to time."""
        self._update()
        if self._alone and self._accepted is None and self._next != NONE_YET:
            self._accepted = self._listed[0]
        self._report.publishers(self._listed, self._rule, self.rejected)

    @property
    def _rule(self) -> str:
        """Which messages are accepted while there are several publishers."""
        if self._next == NONE_YET:
            return "no message is accepted until there is only one"
        accepted = self._accepted
        if accepted is None:
            return "only messages from one of them are accepted"
        if sum(publisher.node == accepted.node for publisher in self._listed) > 1:
            return "only messages from the one that was first are accepted"
        return f"only messages from {accepted.node} are accepted"

    @property
    def _alone(self) -> bool:
        """Whether the topic has one publisher."""
        return len(self._listed) == 1

    def _update(self) -> None:
        """Look up the publishers, always anew if there was only one."""
        now = self._now()
        if len(self._listed) > 1 and now - self._lookup_time < LOOKUP_PERIOD:
            return
        self._lookup_time, self._listed = now, self._look_up()
        for publisher in self._listed:
            if self._accepted is not None and publisher.identity == self._accepted.identity:
                self._accepted = publisher  # its name may have been unknown so far

    def _is_accepted(self, number: int | None) -> bool:
        """Whether a message that does not continue the sequence is accepted."""
        if number is None:
            return self._alone
        if number == self._next - 1 and not self._alone:
            self._next, self._accepted = NONE_YET, None  # two sequences coincide
        time = self._candidate.time_alone(number, self._next, self._now())
        if self._follows(number) or (time >= HANDOVER_TIME and self._may_replace(number)):
            self._next = number + 1
            self._accepted = self._listed[0] if self._alone else None
            if not self._alone and not self._only_restarts:
                self._report.replacement(self._listed)
            self._known = frozenset(publisher.identity for publisher in self._listed)
            return True
        return False

    def _follows(self, number: int) -> bool:
        """Whether messages were lost, or the accepted publisher has ended or is the first one."""
        ended = self._accepted is not None and not any(
            publisher.identity == self._accepted.identity for publisher in self._listed
        )
        if self._next == NONE_YET:
            return ended or self._alone
        return ended or (number > self._next and (self._alone or self._only_restarts))

    @property
    def _only_restarts(self) -> bool:
        """Whether the publishers besides the accepted one are its killed predecessors.

        They have its node name and were silent when it replaced them.
        """
        names = {publisher.node for publisher in self._listed}
        return len(names) == 1 and all(
            publisher.identity in self._known for publisher in self._listed
        )

    def _may_replace(self, number: int) -> bool:
        """Whether a sequence may replace the accepted one, which is silent."""
        accepted = self._accepted
        if accepted is None or self._alone or number > self._next:
            return True
        others = [
            publisher.node for publisher in self._listed if publisher.identity != accepted.identity
        ]
        return accepted.node in others


class _Candidate:
    """A sequence that may replace the accepted one."""

    def __init__(self) -> None:
        self._next, self._accepted_next = NONE_YET, -1
        self._since = 0.0

    def time_alone(self, number: int, accepted_next: int, now: float) -> float:
        """Time [s] for which only messages of this sequence have been received.

        Messages of it may be lost. Two publishers at once do not form one rising sequence.
        """
        if number < self._next or accepted_next != self._accepted_next:
            self._since = now
        self._next, self._accepted_next = number + 1, accepted_next
        return now - self._since
