"""Coarse fits that lead near the optimum: in growing segments, then of all recordings together."""

import numpy as np

from furuta_identification.shooting.optimisation import Optimum, optimise, residual_scale
from furuta_identification.shooting.segments import cut_into_segments
from furuta_identification.shooting.shooting import Shooting
from furuta_identification.shooting.unknowns import ParameterValues, is_zero
from furuta_recordings.recording import Recording

# Lengths of the segments [s], one fit after the other: the longer a segment, the better its start
# must be.
SEGMENT_LENGTHS = (0.5, 1.5, np.inf)


def fit_growing_segments(
    excerpts: list[Recording],
    names: list[str],
    start: ParameterValues,
    window: float,
    scale: np.ndarray,
) -> Optimum:
    """Fit one recording in ever longer segments of at most ``window`` [s].

    After each fit its residuals weight the channels anew. The ``excerpts`` of a recording share its
    zero.
    """
    for length in SEGMENT_LENGTHS:
        optimum = optimise(excerpts, names, start, min(length, window), scale, robust=True)
        start, scale = optimum.values, residual_scale(optimum)
    return optimum


def fit_together(
    recordings: list[Recording],
    names: list[str],
    own_fits: list[Optimum],
    window: float,
    scale: np.ndarray,
) -> Optimum:
    """The common fit of all recordings, started from the fit of one that suits all best.

    Each recording alone leads near the common optimum. A common fit from a worse start can end in
    a local optimum. Each recording has its own zero.
    """
    if len(own_fits) == 1:
        return own_fits[0]
    zeros = [fit.values["zero"] for fit in own_fits]
    zero_names = [name for name in names if is_zero(name)]
    starts = [fit.values.changed(zero_names, zeros) for fit in own_fits]

    def common_misfit(start: ParameterValues) -> float:
        parts = [cut_into_segments(r, window, scale, start) for r in recordings]
        residuals = Shooting(parts, names, start).residuals(start.vector(names))
        return float(np.sum(np.log1p(residuals**2)))

    best = min(starts, key=common_misfit)
    return optimise(recordings, names, best, window, scale, robust=True)
