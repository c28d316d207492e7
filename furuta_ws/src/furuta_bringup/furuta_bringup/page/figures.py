"""Figures of the newest motion: size, period, what is left in encoder counts, late samples."""

from math import isfinite, nan, pi
from typing import Any, NamedTuple

import numpy as np

from furuta.oscillation import measure_oscillation
from furuta_bringup.page.samples import PHI, THETA_DOT, TIME

# Time that is measured [s]: two periods of the paper's limit cycle.
MEASURED = 5.0
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

    def rows(self) -> list[tuple[str, str]]:
        """Names and values with units."""
        return [
            ("arm, peak to peak", _number(self.phi_peak_to_peak, 3, "rad")),
            ("pendulum, peak to peak", _number(self.theta_peak_to_peak, 4, "rad")),
            ("period", _number(self.period, 2, "s")),
            ("arm in encoder counts", _number(self.counts, 1, "")),
        ]


def figures(samples: np.ndarray, encoder_counts: int) -> Figures:
    """The figures of the newest samples (n, 8); without encoder (0 counts) there are no counts."""
    samples = samples[samples[:, TIME] > samples[-1:, TIME] - MEASURED]
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
        return "–"
    latency = np.array(timing.data).reshape(TIMING_ROWS, -1)[0]
    width = float(timing.layout.dim[1].label.split()[-2])
    return f"{int(latency[int(np.ceil(LATE / width)) :].sum())} of {int(latency.sum())}"


def _number(value: float, digits: int, unit: str) -> str:
    return f"{value:.{digits}f} {unit}".rstrip() if isfinite(value) else "–"
