r"""A linear loop with one friction joint.

.. math:: \dot x = A x + r - b (F + σ_2 v), \qquad x = (v, w), \qquad b_v > 0

v is the speed of the joint, and w all other states: loads, controller, filters, and the position if
the loop feeds it back. The state is (q, v, w, z) with :math:`\dot q = v`. While the joint sticks,
friction holds v = 0 with :math:`F_{hold} = (A x + r)_v / b_v`, and w goes on.

The loop is without units; :mod:`.joint` scales one that has units so that its motions are of order
1 and its poles of order 10.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled
from furuta_model.friction.laws import FrictionLaw, sliding_level
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT

W = PHI_DOT + 1  # the first of the other states
BRISTLE = -1
LARGEST = 1e6  # a state beyond it is unbounded
MAX_STEP = 0.02  # while the joint slides
# A joint that an integrator pulls breaks away after a time in inverse proportion to its error.
LONGEST_RETURN = 1e12


class LinearLoop(NamedTuple):
    """A (n, n), b (n,) and r (n,) of the loop, and its friction law.

    ``passes_rests``: a motion that creeps near a rest is followed on, as past an unstable one.
    """

    a: np.ndarray
    b: np.ndarray
    r: np.ndarray
    law: FrictionLaw
    held: float = 0.0
    passes_rests: bool = False

    @property
    def states(self) -> int:
        """Length of the state, with position and bristle."""
        return len(self.b) + 2

    @property
    def free(self) -> list[int]:
        """Coordinates of the state at a reversal: w, and the bristle."""
        others = list(range(W, self.states - 1))
        return [*others, self.states - 1] if self.law.bristle else others

    @property
    def longest_return(self) -> float:
        """Longest time between two reversals."""
        return LONGEST_RETURN

    def check(self) -> None:
        """Raise :class:`ParameterError` if it cannot be followed."""
        if not all(np.all(np.isfinite(part)) for part in (self.a, self.b, self.r)):
            raise ParameterError("the numbers of a loop must be finite")
        if not self.b[0] > 0.0:
            raise ParameterError("a force on the joint must accelerate it in its own direction")


@compiled
def holding_force(y: np.ndarray, loop: LinearLoop) -> float:
    """Friction that holds the joint at rest."""
    force = loop.r[0]
    for j in range(len(loop.b)):
        force += loop.a[0, j] * y[PHI_DOT + j]
    return force / loop.b[0]


@compiled
def control(y: np.ndarray, loop: LinearLoop) -> float:
    """All force on the joint but friction."""
    return holding_force(y, loop)


@compiled
def sliding_rate(y: np.ndarray, force: float, dy: np.ndarray, loop: LinearLoop) -> None:
    """Compute ẏ under friction ``force`` and viscous friction."""
    n = len(loop.b)
    friction = force + loop.law.parameters.viscous * y[PHI_DOT]
    dy[PHI] = y[PHI_DOT]
    for i in range(n):
        rate = loop.r[i] - loop.b[i] * friction
        for j in range(n):
            rate += loop.a[i, j] * y[PHI_DOT + j]
        dy[PHI_DOT + i] = rate


@compiled
def stuck_rate(y: np.ndarray, dy: np.ndarray, loop: LinearLoop) -> None:
    """Compute ẏ while friction holds the joint."""
    sliding_rate(y, holding_force(y, loop), dy, loop)
    dy[PHI], dy[PHI_DOT] = 0.0, 0.0


@compiled
def rest_distance(y: np.ndarray, mode: float, loop: LinearLoop) -> float:
    """Root of the sum of squares of all rates but that of q: zero at rest and in steady motion."""
    dy = np.zeros(len(y))
    p, v = loop.law.parameters, y[PHI_DOT]
    if mode == 0.0:
        stuck_rate(y, dy, loop)
    elif loop.law.bristle:
        z = y[BRISTLE]
        sliding_rate(y, p.sigma0 * z, dy, loop)
        dy[BRISTLE] = v * (1.0 - mode * p.sigma0 * z / sliding_level(v, mode, loop.law))
    else:
        sliding_rate(y, mode * sliding_level(v, mode, loop.law), dy, loop)
    total = 0.0
    for i in range(PHI_DOT, len(y)):
        total += dy[i] * dy[i]
    return sqrt(total)


@compiled
def unbounded(y: np.ndarray, loop: LinearLoop) -> bool:
    """Whether a state but the position is beyond all bounds."""
    largest = 0.0
    for i in range(PHI_DOT, len(y)):
        largest = max(largest, abs(y[i]))
    return not largest <= LARGEST


@compiled
def longest_step(mode: float, loop: LinearLoop) -> float:
    """Longest step of the integration; a stuck joint can wait for ever."""
    return np.inf if mode == 0.0 else MAX_STEP
