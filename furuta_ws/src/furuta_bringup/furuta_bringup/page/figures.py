"""Figures of the newest motion: size, period, what is left in encoder counts, late samples."""

from math import ceil, degrees, isfinite, nan, pi
from typing import Any, NamedTuple

import numpy as np

from furuta.oscillation import measure_oscillation
from furuta_bringup.page.guided_scenes import MEASURED
from furuta_bringup.page.samples import PHI, THETA_DOT, TIME

# Angle below which two digits are shown [°].
FINE = 3.0
UNKNOWN = "–"
# Time between samples [s] after which the motion is another one. A reset takes 0.2 s.
GAP = 0.15
# Fewest samples that are measured.
FEWEST = 10
# An oscillation below this many encoder counts has no period that means anything.
SMALLEST_PERIODIC = 2.0
# Latency [µs] from which a sample is late: that of the next sample.
LATE = 1000.0
# The rows of ``timing``: latency from measurement to command first.
TIMING_ROWS = 2


class Figures(NamedTuple):
    """Peak to peak of arm and pendulum [rad], period [s], arm in counts; NaN where unknown."""

    phi_peak_to_peak: float = nan
    theta_peak_to_peak: float = nan
    period: float = nan
    counts: float = nan

    def rows(self, wait: str = "") -> list[tuple[str, str]]:
        """Names and values with units; ``wait`` stands for values that are not known yet."""
        values = [
            swing(self.phi_peak_to_peak, " peak to peak"),
            swing(self.theta_peak_to_peak, " peak to peak"),
            f"{self.period:.2f} s" if isfinite(self.period) else UNKNOWN,
            f"{self.counts:.1f}" if isfinite(self.counts) else UNKNOWN,
        ]
        names = "arm", "pendulum", "period", "arm in encoder counts"
        return list(zip(names, [wait, "", "", ""] if wait else values, strict=True))


class Elapsed:
    """Time of the plant since the settings have changed, or since a reset."""

    def __init__(self) -> None:
        self._since: float | None = None

    def restart(self) -> None:
        """Something has changed."""
        self._since = None

    def passed(self, times: np.ndarray) -> float:
        """The time [s] up to the newest of ``times``, of which a reset leaves some out."""
        newest = float(times[-1])
        if self._since is None or newest < self._since:
            self._since = newest
        gaps = np.flatnonzero(np.diff(times) > GAP)
        if len(gaps):
            self._since = max(self._since, float(times[gaps[-1] + 1]))
        return newest - self._since


def measuring(passed: float, full: float) -> str:
    """How long it takes until all of the time [s] is ``full``; empty if it is."""
    return f"measuring: {ceil(full - passed)} s" if passed < full else ""


def swing(angle: float, how: str = "") -> str:
    """An angle [rad] in degrees, as people read it, and ``how`` it was measured."""
    size = degrees(angle)
    return f"{size:.{2 if size < FINE else 1}f}°{how}" if isfinite(size) else UNKNOWN


def figures(samples: np.ndarray, encoder_counts: int) -> Figures:
    """The figures of the newest samples (n, 8); without encoder (0 counts) there are no counts."""
    samples = samples[samples[:, TIME] > samples[-1:, TIME] - MEASURED.window]
    states = samples[:, PHI : THETA_DOT + 1]
    known = np.isfinite(states).all(axis=1)
    if known.sum() < FEWEST:
        return Figures()
    times = samples[known, TIME]
    step = float((times[-1] - times[0]) / (len(times) - 1))
    motion = measure_oscillation(states[known], step)
    counts = motion.phi_peak_to_peak_rad * encoder_counts / (2 * pi) if encoder_counts else nan
    periodic = not isfinite(counts) or counts >= SMALLEST_PERIODIC
    return Figures(
        motion.phi_peak_to_peak_rad,
        motion.theta_peak_to_peak_rad,
        motion.period_s if periodic else nan,
        counts,
    )


def late_samples(timing: Any, status: Any) -> str:
    """Samples whose command came after the next sample, of all since the plant started.

    ``timing`` is the newest message on that topic, ``status`` that of the bridge to a rig, or None.
    """
    if status is not None:
        values = {pair.key: pair.value for pair in status.values}
        return f"{values.get('samples skipped', '0')} of {values.get('samples', '0')}"
    if timing is None:
        return UNKNOWN
    latency = np.array(timing.data).reshape(TIMING_ROWS, -1)[0]
    width = float(timing.layout.dim[1].label.split()[-2])
    return f"{int(latency[int(np.ceil(LATE / width)) :].sum())} of {int(latency.sum())}"
