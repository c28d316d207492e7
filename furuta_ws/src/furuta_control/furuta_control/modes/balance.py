"""Mode ``balance``: state feedback about upright with friction compensation, eqs. (6) to (8).

Sign convention of the whole workspace: (1) has u − F on its right side, with F > 0 if friction
opposes positive arm speed. The estimate F̂ is therefore *added*:

    u = −Lx + F̂

The scan of the paper has a minus in (8), which would double the friction.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT


class Balance(NamedTuple):
    """Gain L of u = −Lx [V per unit of state]; angles [rad] at which balancing stops and starts."""

    l1: float
    l2: float
    l3: float
    l4: float
    fall_angle: float
    catch_angle: float


@inlined
def balances(balancing: float, x: np.ndarray, p: Balance) -> float:
    """Whether the pendulum is balanced (1) or has fallen (0); ``balancing`` is the last result.

    Balancing stops beyond the fall angle and starts within the catch angle.
    """
    tilt = abs(x[THETA])
    if tilt > p.fall_angle:
        return 0.0
    return 1.0 if tilt <= p.catch_angle else balancing


@inlined
def command(x: np.ndarray, friction: float, p: Balance) -> float:
    """Command u [V], unsaturated, for the state estimate ``x`` and friction estimate [V]."""
    return friction - p.l1 * x[PHI] - p.l2 * x[PHI_DOT] - p.l3 * x[THETA] - p.l4 * x[THETA_DOT]
