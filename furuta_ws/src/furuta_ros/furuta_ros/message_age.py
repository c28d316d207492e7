"""Whether a message was sent too long ago to be answered in real time.

A process that has stood still, because it was stopped or the computer was busy, finds the messages
of that time waiting. An answer to them would drive the rig by where it was, not by where it is.
"""

from collections.abc import Callable
from time import time_ns

from furuta_ros.time_stamps import NANOSECONDS

# Longest time from sending to answering a message [s].
MAX_AGE = 0.05
LIMIT = round(MAX_AGE * NANOSECONDS)


class MessageAge:
    """Age of the message that a node answers, by the system's clock.

    ``simulated`` says whether the graph runs on simulated time. The loop then waits for each
    answer, however long it takes, and no message is too old. ``expired`` counts messages; ``sent``
    is when the message received last was sent [ns since 1970], or 0.
    """

    def __init__(self, simulated: Callable[[], bool], now: Callable[[], int] = time_ns) -> None:
        self._simulated, self._now = simulated, now
        self.sent = 0
        self.expired = 0

    def received(self, sent: int) -> bool:
        """Take note of a message sent at ``sent`` [ns since 1970]; returns whether to answer it.

        Some middlewares do not know when a message was sent; they give 0.
        """
        self.sent = sent
        return self.answerable()

    def answerable(self) -> bool:
        """Whether the message received last may still be answered."""
        if not self.sent or self._now() - self.sent <= LIMIT or self._simulated():
            return True
        self.expired += 1
        return False

    @property
    def age(self) -> float:
        """Time since the message received last was sent [s]; 0 if that is not known."""
        return (self._now() - self.sent) / NANOSECONDS if self.sent else 0.0
