r"""Friction with more memory or parameters: the level that varies, the springs of Maxwell-slip.

The level changes with the arm's angle, time, heat and load: every level of the law is multiplied by

.. math::
    1 + a \sin(nφ + φ_0) + d\,(1 - e^{-t/T_d}) + h\,H + l\,|τ|, \qquad
    \dot H = F \dot φ - H/T_h

but never by less than zero. H [V rad] is the heat of the friction and τ [V] the mean torque of the
drive over the sample. Time and heat are evaluated once a sample.
"""

from math import pi, sin
from typing import Annotated, NamedTuple

from furuta_model.compiled import compiled, inlined
from furuta_model.elementary import exp
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
    """How the friction level changes; relative to the level of the law."""

    angle: Annotated[float, About("amplitude of the change of the level over a turn", "", 0, 1)] = (
        0.0
    )
    angle_periods: Annotated[
        int, About("periods of this change per turn", "", 1, 1000, shape=True)
    ] = 1
    angle_phase: Annotated[
        float, About("phase of this change at arm angle 0", "rad", -pi, pi, shape=True)
    ] = 0.0
    drift: Annotated[float, About("final change of the level with time", "", -1, 10)] = 0.0
    drift_time: Annotated[
        float, About("time constant of the drift", "s", 1e-3, 1e6, shape=True)
    ] = 60.0
    heat: Annotated[float, About("change of the level per heat", "1/(V rad)", -100, 100)] = 0.0
    cooling_time: Annotated[
        float, About("time constant of cooling", "s", 1e-3, 1e6, shape=True)
    ] = 60.0
    load: Annotated[float, About("change of the level per torque of the drive", "1/V", 0, 10)] = 0.0


@inlined
def vary_level(
    memory: PlantMemory,
    torque: float,
    friction: float,
    speed: float,
    dt: float,
    p: FrictionVariation,
) -> None:
    """Move heat and level by a sample of ``dt`` [s].

    ``friction`` [V] and ``speed`` [rad/s] are those at its beginning, ``torque`` [V] is the mean.
    """
    cooling = exp(-dt / p.cooling_time)
    memory.heat = memory.heat * cooling + friction * speed * p.cooling_time * (1.0 - cooling)
    drift = p.drift * (1.0 - exp(-memory.moved * dt / p.drift_time))
    memory.level_change = drift + p.heat * memory.heat + p.load * abs(torque)


@compiled
def varied(law: FrictionLaw, phi: float, change: float, p: FrictionVariation) -> FrictionLaw:
    """The law with the levels at arm angle ``phi`` [rad] and a relative ``change``."""
    if p.angle != 0.0:
        change += p.angle * sin(p.angle_periods * phi + p.angle_phase)
    factor = max(1.0 + change, 0.0)
    levels = law.parameters
    return FrictionLaw(
        law.kind,
        with_levels(levels, levels.alpha0 * factor, levels.alpha1 * factor, levels.asymmetry),
        law.level,
        law.breakaway,
        law.bristle,
        law.springs,
    )


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
