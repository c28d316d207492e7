"""Figures of the newest motion: size, period and what is left in encoder counts."""

from __future__ import annotations

from math import isfinite, nan, pi
from typing import NamedTuple

import numpy as np

from furuta_sim.simulation.oscillation import measure_oscillation
from furuta_view.samples import PHI, THETA_DOT, TIME

# Time that is measured [s]: two periods of the paper's limit cycle.
MEASURED = 5.0
# Fewest samples that are measured.
FEWEST = 10
# An oscillation below this many encoder counts has no period that means anything.
SMALLEST_PERIODIC = 2.0


class Figures(NamedTuple):
    """Peak to peak of arm and pendulum [rad], period [s], arm in counts; NaN where unknown."""

    phi_peak_to_peak: float = nan
    theta_peak_to_peak: float = nan
    period: float = nan
    counts: float = nan


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
