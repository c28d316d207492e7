"""How far a graph in lock-step may run."""

FOREVER = 1e9  # [s]
# A single step [s]: to the next sample that the view receives, and a little more.
STEP = 0.012


class Pacer:
    """Sets how fast a graph in lock-step runs, by the time at which the plant pauses.

    A core without clock; times [s] are arguments. ``speed`` is a multiple of real time, 0 while the
    plant pauses, or None: as fast as possible.
    """

    def __init__(self) -> None:
        self.speed: float | None = None
        self._until = 0.0
        self._last: float | None = None

    def pace(self, speed: float | None, plant_time: float) -> None:
        """Run at this speed from now on."""
        self.speed, self._until = speed, plant_time

    def step(self, plant_time: float) -> None:
        """Pause after one more step."""
        self.pace(0.0, plant_time + STEP)

    def run_until(self, now: float, plant_time: float) -> float:
        """The time of the plant up to which it may run, at ``now`` of the steady clock."""
        passed = now - self._last if self._last is not None else 0.0
        self._last = now
        if self.speed is None:
            return FOREVER
        if self.speed:
            # A plant that cannot keep up is not sent ahead.
            ahead = min(max(self._until, plant_time), plant_time + self.speed)
            self._until = ahead + passed * self.speed
        return self._until
