"""Time stamps of a rig's samples."""

# Largest correction of the stamps per period: far above a crystal's error, far below the jitter.
SLEW = 200e-6


class SampleClock:
    """Stamps samples with start time plus whole periods, slowly corrected to the host's clock.

    The rig's crystal differs from the host's clock by about 10⁻⁵. Each stamp is moved towards the
    time of arrival by at most :data:`SLEW` of a period. This follows the median time of arrival
    and suppresses the jitter.
    """

    def __init__(self, period: int) -> None:
        self._period = period
        self._largest = max(1, round(SLEW * period))
        self._start: int | None = None

    def stamp(self, sample: int, now: int) -> int:
        """Compute the stamp [ns] of a sample that arrived at ``now`` [ns]."""
        if self._start is None:
            self._start = now - sample * self._period
        error = now - self._start - sample * self._period
        self._start += min(max(error, -self._largest), self._largest)
        return self._start + sample * self._period
