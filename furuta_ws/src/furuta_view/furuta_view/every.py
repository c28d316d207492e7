"""Says when something that is done periodically is due again."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from time import monotonic


class Every:
    """Due once in ``period`` [s], at once for the first time."""

    def __init__(self, period: float, now: Callable[[], float] = monotonic) -> None:
        self._period, self._now = period, now
        self._last = -inf

    def __call__(self) -> bool:
        """Whether it is due now; then the next time is a period later."""
        now = self._now()
        if now - self._last < self._period:
            return False
        self._last = now
        return True
