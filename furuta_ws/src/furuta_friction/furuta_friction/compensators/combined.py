r"""Combined compensation: levels that are learned for each direction, and the rest as observed.

.. math::
    \hat F = m + r, \qquad m = l_± \tanh(v/w) + σ_2 v, \qquad T\dot r = F_o - m - r

F_o is the friction that the estimator observes. The level l of the direction of motion follows F_o
while the arm slides, so m changes at a reversal without delay. The rest r takes everything that m
does not describe: presliding, stiction, cogging, a level that depends on the angle, errors of the
pendulum's model. With r alone this is a disturbance observer (Ohnishi 1987; Chen, Yang, Guo and Li,
IEEE Trans. Industrial Electronics 63, 2016). The levels start at zero and no friction parameter but
σ₂ is used; the others only limit F̂.
"""

from __future__ import annotations

from math import expm1
from typing import Annotated, NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.elementary import tanh
from furuta_model.parameters import About

# Indices in the compensators' memory: learned level [V] for v > 0 and for v < 0, and the rest [V].
FORWARD, BACKWARD, REST = 3, 4, 5
# Multiple of the reversal speed beyond which tanh(v/w) is nearly 1: there the levels are learned.
SLIDING = 2.0


class CombinedParameters(NamedTuple):
    """Parameters of the compensator."""

    filter_time: Annotated[
        float, About("combined: time constant T of the filter on the rest", "s", 0.0, 1.0)
    ] = 0.003
    reversal_speed: Annotated[
        float, About("combined: speed w at which tanh(v/w) is 0.76", "rad/s", 1e-4, 10.0)
    ] = 0.05
    level_rate: Annotated[
        float, About("combined: rate at which a level is learned", "1/s", 0.0, 1e3)
    ] = 5.0


class Combined(NamedTuple):
    """The sampled compensator: shares of a new value in the rest and in a level."""

    filter_share: float
    level_share: float
    reversal_speed: float


def design(p: CombinedParameters, dt: float) -> Combined:
    """The compensator for the sample time ``dt`` [s]."""
    share = -expm1(-dt / p.filter_time) if p.filter_time > 0.0 else 1.0
    return Combined(share, -expm1(-dt * p.level_rate), p.reversal_speed)


@inlined
def estimate(
    memory: np.ndarray, v: float, observed: float, limit: float, viscous: float, p: Combined
) -> float:
    """F̂ [V] at speed v [rad/s] with the ``observed`` friction [V]; |F̂ − σ₂v| ≤ ``limit`` [V]."""
    forward = v >= 0.0
    learned = memory[FORWARD] if forward else memory[BACKWARD]
    dry = observed - viscous * v
    if abs(v) > SLIDING * p.reversal_speed:
        level = min(max(dry if v > 0.0 else -dry, 0.0), limit)
        learned += p.level_share * (level - learned)
    # An index that depends on the speed could not be vectorised.
    if forward:
        memory[FORWARD] = learned
    else:
        memory[BACKWARD] = learned
    model = learned * tanh(v / p.reversal_speed)
    rest = memory[REST] + p.filter_share * (dry - model - memory[REST])
    memory[REST] = min(max(rest, -limit), limit)
    return min(max(model + memory[REST], -limit), limit) + viscous * v
