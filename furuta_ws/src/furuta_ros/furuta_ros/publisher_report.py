"""Reports several publishers of a topic that must have one, by the names of their nodes."""

from collections.abc import Callable, Sequence
from math import inf
from typing import NamedTuple

# Time [s] between two reports of the same publishers.
REPORT_PERIOD = 5.0


class TopicPublisher(NamedTuple):
    """A publisher of a topic: its identity in the middleware and the full name of its node."""

    identity: bytes
    node: str


class PublisherReport:
    """Passes a line to ``report`` when the publishers change, and again every ``REPORT_PERIOD``."""

    def __init__(self, topic: str, report: Callable[[str], None], now: Callable[[], float]) -> None:
        self._topic, self._report, self._now = topic, report, now
        self._reported: frozenset[bytes] = frozenset()
        self._time = -inf

    def publishers(self, listed: Sequence[TopicPublisher], rule: str, rejected: int) -> None:
        """Report the publishers if there are several; ``rule`` says which are accepted."""
        if len(listed) <= 1:
            self._reported = frozenset()
        elif self._is_due(listed):
            self._report(
                f"{len(listed)} nodes publish {self._topic}: {_names(listed)}; {rule} "
                f"({rejected} rejected so far)"
            )

    def rejection(self, listed: Sequence[TopicPublisher], rule: str, rejected: int) -> None:
        """Report a rejected message, also if its publisher has ended in the meantime."""
        if len(listed) != 1:
            self.publishers(listed, rule, rejected)
        elif self._is_due(listed):
            self._report(
                f"rejected a message on {self._topic}: it is not from the publisher of "
                f"{listed[0].node}, and its own publisher has ended"
            )

    def replacement(self, listed: Sequence[TopicPublisher]) -> None:
        """Report that another publisher is accepted although the accepted one is still listed."""
        self._report(
            f"another publisher of {self._topic} is accepted from now on, of nodes "
            f"{_names(listed)}: the one so far is silent, or messages of it were lost"
        )

    def _is_due(self, listed: Sequence[TopicPublisher]) -> bool:
        present = frozenset(publisher.identity for publisher in listed)
        now = self._now()
        if present == self._reported and now - self._time < REPORT_PERIOD:
            return False
        self._reported, self._time = present, now
        return True


def _names(listed: Sequence[TopicPublisher]) -> str:
    names = sorted(publisher.node for publisher in listed)
    killed = " (a killed node stays listed for up to 20 s)" if len(set(names)) < len(names) else ""
    return " and ".join(names) + killed
