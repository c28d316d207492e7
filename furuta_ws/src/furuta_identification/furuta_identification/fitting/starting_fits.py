"""Coarse fits that lead near the optimum: in growing segments, then of all recordings together."""

from __future__ import annotations

import numpy as np

from furuta_identification.shooting.optimisation import (
    Optimum,
    best_of,
    optimise,
    residual_scale,
    worst_pendulum_fit,
)
from furuta_identification.shooting.parameter_values import ParameterValues
from furuta_identification.shooting.segments import cut_into_segments
from furuta_identification.shooting.shooting import Shooting
from furuta_identification.shooting.unknowns import is_zero
from furuta_recordings.recording import Recording

# Lengths of the segments [s], one fit after the other: the longer a segment, the better its start
# must be. The next schedule is used if the one before does not reach GOOD_FIT.
SEGMENT_SCHEDULES = ((0.5, 1.5, np.inf), (0.3, 0.6, 1.2, 2.4, np.inf), (0.5, np.inf))
# Fit of the pendulum's angle [%] that needs no other schedule.
GOOD_FIT = 95.0
# Number of recordings whose own fits are starts of the common fit.
MOST_STARTS = 2


def fit_growing_segments(
    excerpts: list[Recording],
    names: list[str],
    start: ParameterValues,
    window: float,
    scale: np.ndarray,
) -> Optimum:
    """Fit one recording in ever longer segments; of several schedules the best result.

    The ``excerpts`` of a recording share its zero.
    """
    optima, sizes = [], []
    for schedule in _schedules(window):
        values, size = start, scale
        for length in schedule:
            optimum = optimise(excerpts, names, values, length, size, robust=True)
            values, size = optimum.values, residual_scale(optimum)
        optima.append(optimum)
        sizes.append(float(np.sum((size / scale) ** 2)))
        if worst_pendulum_fit(optimum) > GOOD_FIT:
            break
    return optima[int(np.argmin(sizes))]


def _schedules(window: float) -> list[tuple[float, ...]]:
    """The schedules for segments of at most ``window`` [s], none of them twice."""
    limited = [(min(length, window) for length in schedule) for schedule in SEGMENT_SCHEDULES]
    return list(dict.fromkeys(tuple(dict.fromkeys(lengths)) for lengths in limited))


def fit_together(
    recordings: list[Recording],
    names: list[str],
    own_fits: list[Optimum],
    window: float,
    scale: np.ndarray,
) -> Optimum:
    """The best common fit of all recordings, started from the fits of single recordings.

    Each recording alone leads near the common optimum. A common fit from a worse start can end in
    a local optimum. Each recording has its own zero.
    """
    if len(own_fits) == 1:
        return own_fits[0]
    starts = [_with_all_zeros(fit, names, own_fits) for fit in own_fits]

    def common_misfit(start: ParameterValues) -> float:
        parts = [cut_into_segments(r, window, scale, start) for r in recordings]
        return Optimum(start, Shooting(parts, names, start), start.vector(names), window).misfit

    return best_of(
        optimise(recordings, names, start, window, scale, robust=True)
        for start in sorted(starts, key=common_misfit)[:MOST_STARTS]
    )


def _with_all_zeros(fit: Optimum, names: list[str], own_fits: list[Optimum]) -> ParameterValues:
    """The values of a recording's own fit with the zeros of all recordings."""
    zeros = [own.values["zero"] for own in own_fits]
    return fit.values.changed([name for name in names if is_zero(name)], zeros)
