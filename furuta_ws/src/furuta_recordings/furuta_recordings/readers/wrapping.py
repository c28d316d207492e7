"""Continues angles that begin anew after a turn, and encoders' counts that overflow."""

from math import pi

import numpy as np

from furuta_recordings.readers.columns import ANGLE_UNITS, COUNT_UNITS

# Part of the turn by which angles may exceed it, and by which a counter's size may be misjudged.
MARGIN = 0.01
# The counts of a turn are a power of two, or a multiple of this.
ROUND = 100.0
# Part of the travel from which a step may be an overflow.
LARGE = 0.5


def continuous(values: np.ndarray, unit: str) -> tuple[np.ndarray, float]:
    """Angles or counts (n,) without jumps by a turn, and the size of that turn, or 0.

    A recording that exceeds a turn, or has no jump of half of it, is left as it is.
    """
    known = np.isfinite(values)
    steps = np.abs(np.diff(values[known]))
    if not len(steps):
        return values, 0.0
    travel = float(np.ptp(values[known]))
    if not np.max(steps) > LARGE * travel:
        return values, 0.0
    if unit in ANGLE_UNITS:
        turns = [2.0 * pi / ANGLE_UNITS[unit]]
    else:
        turns = [] if unit else [2.0 * pi, 360.0]
    turns = [turn for turn in turns if travel <= (1.0 + MARGIN) * turn]
    if not unit or unit in COUNT_UNITS:
        turns += _counters(values[known])
    turn = next((turn for turn in turns if np.max(steps) > 0.5 * turn), 0.0)
    if not turn:
        return values, 0.0
    result = values.copy()
    result[known] = np.unwrap(values[known], period=turn)
    return result, turn


def _counters(counts: np.ndarray) -> list[float]:
    """The size of the counter that these counts may come from, if they do.

    It is what the jumps show together with the steps beside them, and the counts reach its ends.
    """
    steps, low, high = np.diff(counts), np.min(counts), np.max(counts)
    if np.any(counts != np.round(counts)):
        return []
    jumps = np.abs(steps) > LARGE * (high - low)
    usual = np.where(jumps, 0.0, steps)
    beside = 0.5 * (np.append(0.0, usual[:-1]) + np.append(usual[1:], 0.0))
    shown = float(np.median(np.abs(steps - beside)[jumps]))
    power, multiple = 2.0 ** round(np.log2(shown)), ROUND * round(shown / ROUND)
    size = power if abs(shown - power) <= MARGIN * power else multiple
    start = 0.0 if low >= 0.0 else -0.5 * size
    slack = 1.0 + 2.0 * float(np.max(np.abs(usual)))
    inside = start <= low and high < start + size and high - low >= size - slack
    return [size] if inside and abs(shown - size) <= max(MARGIN * power, 0.25 * ROUND) else []
