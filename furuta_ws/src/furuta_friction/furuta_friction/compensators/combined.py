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

from dataclasses import dataclass
from math import expm1, isnan
from typing import Annotated, NamedTuple

import numpy as np

from furuta_friction.compensator import Joint
from furuta_friction.compensators.adaptive import LARGEST_FACTOR
from furuta_model.compiled import inlined
from furuta_model.elementary import tanh
from furuta_model.friction.lugre import highest_level
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import About
from furuta_model.state import OBSERVED_FRICTION, PHI_DOT

# Multiple of the reversal speed beyond which tanh(v/w) is nearly 1: there the levels are learned.
SLIDING = 2.0


@dataclass
class CombinedMemory:
    """Learned level [V] for v > 0 and for v < 0, and the rest [V]."""

    forward: float = 0.0
    backward: float = 0.0
    rest: float = 0.0


class CombinedParameters(NamedTuple):
    """Parameters of the compensator."""

    filter_time: Annotated[
        float, About("combined: time constant of the filter on the rest", "s", 0.0, 1.0)
    ] = 0.003
    reversal_speed: Annotated[
        float,
        About(
            "combined: speed w within which the level changes sign, tanh(v/w)", "rad/s", 1e-9, 1e3
        ),
    ] = 0.05
    level_rate: Annotated[
        float, About("combined: rate at which a level is learned", "1/s", 0.0, 1e3)
    ] = 5.0


class Combined(NamedTuple):
    """The sampled compensator: shares of a new value in the rest and in a level."""

    friction: Friction
    filter_share: float
    level_share: float
    reversal_speed: float


def design(joint: Joint, p: CombinedParameters) -> Combined:
    """The compensator for the sample time of a joint."""
    dt = joint.sample_time
    share = -expm1(-dt / p.filter_time) if p.filter_time > 0.0 else 1.0
    return Combined(joint.friction, share, -expm1(-dt * p.level_rate), p.reversal_speed)


@inlined
def estimate(memory: CombinedMemory, x: np.ndarray, p: Combined) -> float:
    """F̂ [V]; without its viscous part at most the highest level that adaptation allows."""
    if isnan(x[OBSERVED_FRICTION]):
        return 0.0
    v, viscous = x[PHI_DOT], p.friction.viscous * x[PHI_DOT]
    limit = LARGEST_FACTOR * highest_level(p.friction)
    return _dry_friction(memory, v, x[OBSERVED_FRICTION] - viscous, limit, p) + viscous


@inlined
def _dry_friction(
    memory: CombinedMemory, v: float, observed: float, limit: float, p: Combined
) -> float:
    """F̂ [V] at speed v [rad/s], at most ``limit`` [V]; it and ``observed`` without viscous part."""
    forward = v >= 0.0
    learned = memory.forward if forward else memory.backward
    if abs(v) > SLIDING * p.reversal_speed:
        level = min(max(observed if v > 0.0 else -observed, 0.0), limit)
        learned += p.level_share * (level - learned)
    if forward:
        memory.forward = learned
    else:
        memory.backward = learned
    model = learned * tanh(v / p.reversal_speed)
    rest = memory.rest + p.filter_share * (observed - model - memory.rest)
    memory.rest = min(max(rest, -limit), limit)
    return min(max(model + memory.rest, -limit), limit)
