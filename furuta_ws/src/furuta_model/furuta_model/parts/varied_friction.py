r"""Friction with more memory or parameters: the level that varies, the springs of Maxwell-slip.

The level changes with the arm's angle: every level of the law is multiplied by
:math:`1 + a \sin(nφ + φ_0)`.
"""

from math import pi, sin
from typing import Annotated, NamedTuple

from furuta_model.compiled import compiled, inlined
from furuta_model.friction.laws import (
    FrictionLaw,
    bristle_force,
    friction_force,
    sliding_level,
)
from furuta_model.friction.levels import with_levels
from furuta_model.friction.maxwell_slip import slip_deflection, stretched
from furuta_model.parameters import About
from furuta_model.parts.plant_memory import MotorMemory, PlantMemory

# Whose springs of the Maxwell-slip law: those of the arm, or those of its motor.
SpringMemory = PlantMemory | MotorMemory


class FrictionVariation(NamedTuple):
    """How the friction level changes with the angle; relative to the level of the law."""

    angle: Annotated[float, About("amplitude of the change of the level over a turn", "", 0, 1)] = (
        0.0
    )
    angle_periods: Annotated[
        int, About("periods of this change per turn", "", 1, 1000, shape=True)
    ] = 1
    angle_phase: Annotated[
        float, About("phase of this change at arm angle 0", "rad", -pi, pi, shape=True)
    ] = 0.0


@compiled
def varied(law: FrictionLaw, phi: float, change: FrictionVariation) -> FrictionLaw:
    """The law with the levels at arm angle ``phi`` [rad]."""
    factor, levels = 1.0, law.parameters
    if change.angle != 0.0:
        factor += change.angle * sin(change.angle_periods * phi + change.angle_phase)
    p = with_levels(levels, levels.alpha0 * factor, levels.alpha1 * factor, levels.asymmetry)
    return FrictionLaw(law.kind, p, law.level, law.breakaway, law.bristle, law.springs)


@inlined
def presliding_force(
    memory: SpringMemory, v: float, z: float, h: float, springs: int, law: FrictionLaw
) -> tuple[float, float]:
    """Mean friction [V] of bristle or springs over ``h`` [s] at speed v [rad/s], without σ₂v.

    Exact for constant v. ``z`` is the deflection of the bristle [rad]. Also returns the deflection
    at the end [rad], of springs the mean one; theirs are kept for :func:`keep_springs`.
    """
    if not law.springs:
        return bristle_force(v, z, h, law)
    p = law.parameters
    level = sliding_level(v, v, law)
    end = mean = 0.0
    for i in range(springs):
        slip = slip_deflection(i, springs, level, p)
        memory.next_springs[i], mean_deflection = stretched(memory.springs[i], v * h, slip)
        end += memory.next_springs[i]
        mean += mean_deflection
    return p.sigma0 * mean / springs, end / springs


@inlined
def keep_springs(memory: SpringMemory, springs: int) -> None:
    """Take the deflections that :func:`presliding_force` computed last."""
    for i in range(springs):
        memory.springs[i] = memory.next_springs[i]


@inlined
def joint_friction(
    memory: SpringMemory, v: float, z: float, springs: int, law: FrictionLaw
) -> float:
    """Friction F [V] of arm or motor at speed v [rad/s], with viscous part.

    ``z`` is the state of a law without springs (:func:`furuta_model.friction.laws.friction_force`).
    """
    if not law.springs:
        return friction_force(v, z, law)
    p = law.parameters
    level = sliding_level(v, v, law)
    force = 0.0
    for i in range(springs):
        z, slip = memory.springs[i], slip_deflection(i, springs, level, p)
        if v > 0.0:
            z = min(z, slip)
        elif v < 0.0:
            z = max(z, -slip)
        force += p.sigma0 * z
    return force / springs + p.viscous * v
