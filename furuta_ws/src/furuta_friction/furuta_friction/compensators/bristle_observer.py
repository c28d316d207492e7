r"""The friction observer (9): the bristle's equation (5) run on the estimated speed.

.. math::
    \dot{\hat z} = v - σ_0\frac{|v|}{g(v)}\hat z - K e, \qquad
    \hat F = σ_0\hat z + σ_1\dot{\hat z} + σ_2 v

K appears in no equation of the paper. In [6], the work that the paper cites, e is the position
error of the joint with friction; here that is the arm angle φ, whose reference is zero. The
correction alone would drive ẑ without limit while v = 0, so ẑ is kept where the true z must be,
σ₀|ẑ| ≤ max g, and F̂ within the highest friction that the parameters allow at that speed.
"""

from __future__ import annotations

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.friction.lugre import bristle_after, bristle_rate, highest_level
from furuta_model.friction.parameters import LuGre

# Place of ẑ [rad] in the compensators' memory.
BRISTLE = 0


@inlined
def observe(memory: np.ndarray, v: float, correction: float, dt: float, p: LuGre) -> float:
    """Move ẑ by one sample at speed v [rad/s] and return F̂ [V]; ``correction`` is −Ke [rad/s]."""
    z, _ = bristle_after(v, correction, memory[BRISTLE], dt, p)
    highest = highest_level(p)
    limit = highest / p.sigma0
    z = min(max(z, -limit), limit)
    memory[BRISTLE] = z
    force = p.sigma0 * z + p.sigma1 * (bristle_rate(v, z, p) + correction)
    return min(max(force, -highest), highest) + p.viscous * v
