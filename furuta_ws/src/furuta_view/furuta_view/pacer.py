"""Sets how fast a graph in lock-step runs, by raising the time at which the plant pauses."""

from __future__ import annotations

# Speeds relative to real time; None: as fast as the machine allows.
SPEEDS: dict[str, float | None] = {
    "slow, 1/10": 0.1,
    "half": 0.5,
    "real time": 1.0,
    "double": 2.0,
    "five times": 5.0,
    "as fast as possible": None,
}
FASTEST = "as fast as possible"
FOREVER = 1e9  # [s]


class Pacer:
    """Determines ``run_until``. A core without clock; times [s] are arguments."""

    def __init__(self) -> None:
        self.speed: float | None = None
        self.paused = False
        self._until = 0.0
        self._last: float | None = None

    @property
    def holds(self) -> bool:
        """Whether the plant waits for this pacer."""
        return self.paused or self.speed is not None

    def run_until(self, now: float, plant_time: float) -> float:
        """The time of the plant up to which it may run, at ``now`` of the steady clock."""
        passed = now - self._last if self._last is not None else 0.0
        self._last = now
        if self.paused:
            self._until = plant_time
            return plant_time
        if self.speed is None:
            self._until = plant_time
            return FOREVER
        # A plant that cannot keep up is not sent ahead.
        self._until = min(max(self._until, plant_time), plant_time + self.speed) + (
            passed * self.speed
        )
        return self._until
