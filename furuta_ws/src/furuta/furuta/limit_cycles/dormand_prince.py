"""Step of the Dormand–Prince pair 5(4) for a loop with friction."""

from math import inf, isfinite

import numpy as np

from furuta.limit_cycles.friction_loop import FrictionLoop, rate
from furuta_model.compiled import compiled

RELATIVE_TOLERANCE = 1e-9
ABSOLUTE_TOLERANCE = 1e-11


@compiled
def step(
    y: np.ndarray,
    h: float,
    mode: float,
    loop: FrictionLoop,
    size: float,
    k: np.ndarray,
    end: np.ndarray,
) -> float:
    """One step of ``h`` [s] from ``y`` to ``end``; returns the error, at most 1 within tolerance.

    ``size`` is that of a small motion, in proportion to which the absolute tolerance is reduced.
    ``k`` (7, n) is work space. Row 0 must hold the rate at ``y``; row 6 gets the rate at ``end``.
    """
    n = len(y)
    for i in range(n):
        end[i] = y[i] + h * (1 / 5) * k[0, i]
    rate(end, mode, loop, k[1])
    for i in range(n):
        end[i] = y[i] + h * (3 / 40 * k[0, i] + 9 / 40 * k[1, i])
    rate(end, mode, loop, k[2])
    for i in range(n):
        end[i] = y[i] + h * (44 / 45 * k[0, i] - 56 / 15 * k[1, i] + 32 / 9 * k[2, i])
    rate(end, mode, loop, k[3])
    for i in range(n):
        end[i] = y[i] + h * (
            19372 / 6561 * k[0, i]
            - 25360 / 2187 * k[1, i]
            + 64448 / 6561 * k[2, i]
            - 212 / 729 * k[3, i]
        )
    rate(end, mode, loop, k[4])
    for i in range(n):
        end[i] = y[i] + h * (
            9017 / 3168 * k[0, i]
            - 355 / 33 * k[1, i]
            + 46732 / 5247 * k[2, i]
            + 49 / 176 * k[3, i]
            - 5103 / 18656 * k[4, i]
        )
    rate(end, mode, loop, k[5])
    for i in range(n):
        end[i] = y[i] + h * (
            35 / 384 * k[0, i]
            + 500 / 1113 * k[2, i]
            + 125 / 192 * k[3, i]
            - 2187 / 6784 * k[4, i]
            + 11 / 84 * k[5, i]
        )
    rate(end, mode, loop, k[6])
    worst = 0.0
    for i in range(n):
        error = h * (
            71 / 57600 * k[0, i]
            - 71 / 16695 * k[2, i]
            + 71 / 1920 * k[3, i]
            - 17253 / 339200 * k[4, i]
            + 22 / 525 * k[5, i]
            - 1 / 40 * k[6, i]
        )
        scale = size * ABSOLUTE_TOLERANCE + RELATIVE_TOLERANCE * max(abs(y[i]), abs(end[i]))
        if not isfinite(error):  # the maximum would lose it
            return inf
        worst = max(worst, abs(error) / scale)
    return worst
