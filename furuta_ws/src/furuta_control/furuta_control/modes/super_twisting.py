r"""Super-twisting rejection of friction, as an integral sliding mode on the arm's speed.

.. math::
    s = \frac{1}{b}\Bigl(\dot φ - \int (A - BL)_{\dot φ}\,x\,dt\Bigr), \qquad
    v = -1.5\sqrt{C}\sqrt{|s|}\,\mathrm{sgn}\,s + w, \qquad \dot w = -1.1\,C\,\mathrm{sgn}\,s

The sliding variable s [V s] is how much friction has changed the arm's speed (Utkin and Shi 1996).
The correction v is added to u = −Lx. C [V/s] bounds the rate at which friction changes. The gains
are those of Levant (Int. J. Control 58, 1993).
"""

from dataclasses import dataclass
from math import copysign, sqrt
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.linear import linearize
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI_DOT, THETA, THETA_DOT


@dataclass
class SuperTwistingMemory:
    """Whether it has started, the arm's speed without friction [rad/s], and w [V]."""

    started: bool = False
    speed: float = 0.0
    correction: float = 0.0


class SuperTwisting(NamedTuple):
    """The sampled law: bound C [V/s] (0: off), (A − BL) of φ̇, b [rad/s²/V], and dt [s]."""

    rate_bound: float
    a1: float
    a2: float
    a3: float
    a4: float
    b: float
    dt: float


def design(
    rate_bound: float, model: FurutaPendulum, viscous: float, gain: tuple[float, ...], dt: float
) -> SuperTwisting:
    """The law for the feedback ``gain`` L (4,); ``viscous`` friction [V s/rad] is in the model."""
    a, b = linearize(model, viscous)
    a1, a2, a3, a4 = (a[PHI_DOT] - b[PHI_DOT] * np.array(gain)).tolist()
    b_arm = float(b[PHI_DOT])
    return SuperTwisting(rate_bound=rate_bound, a1=a1, a2=a2, a3=a3, a4=a4, b=b_arm, dt=dt)


@inlined
def correction(
    memory: SuperTwistingMemory, x: np.ndarray, error: float, limit: float, p: SuperTwisting
) -> float:
    """The correction v [V] for state ``x`` and arm error [rad]; |w| ≤ ``limit`` [V]."""
    if not memory.started:
        memory.started, memory.speed, memory.correction = True, x[PHI_DOT], 0.0
    s = (x[PHI_DOT] - memory.speed) / p.b
    acceleration = p.a1 * error + p.a2 * x[PHI_DOT] + p.a3 * x[THETA] + p.a4 * x[THETA_DOT]
    memory.speed += p.dt * acceleration
    w = memory.correction - copysign(1.1 * p.rate_bound * p.dt, s)
    memory.correction = min(max(w, -limit), limit)
    return memory.correction - copysign(1.5 * sqrt(p.rate_bound * abs(s)), s)
