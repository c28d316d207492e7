r"""All friction laws under one interface: the registry.

==========  ==============================================  =====================
law         sliding, v ≠ 0                                  breaks away beyond
==========  ==============================================  =====================
coulomb     α₀ sgn v, eq. (4)                               α₀
stiction    α₀ sgn v                                        α₀ + α₁
stribeck    (α₀ + α₁ exp(−(v/vs)²)) sgn v                   α₀ + α₁
lugre       bristle dynamics, eq. (5); in the mean the      (none: it creeps)
            Stribeck curve
==========  ==============================================  =====================

Each law adds the viscous part σ₂v and the factor 1 ± asymmetry by direction. To add a law, write
its file and add it to :data:`ALL`.
"""

from __future__ import annotations

from typing import NamedTuple

from furuta_model.compiled import by_kind, compiled
from furuta_model.friction import coulomb, lugre, stiction, stribeck
from furuta_model.friction.bristle import deflection_after, deflection_rate
from furuta_model.friction.law import Law
from furuta_model.friction.parameters import LuGre

ALL: tuple[Law, ...] = (coulomb.LAW, stiction.LAW, stribeck.LAW, lugre.LAW)

LAWS = tuple(law.name for law in ALL)
BRISTLE = tuple(law.bristle for law in ALL)
# Arm speed [rad/s] below which the arm is stuck under a law without bristle.
STUCK = 1e-9
_level = by_kind([law.level for law in ALL])
_breakaway = by_kind([law.breakaway for law in ALL])


class FrictionLaw(NamedTuple):
    """A law (index into :data:`LAWS`) with its parameters; what compiled code computes with."""

    kind: int = LAWS.index("lugre")
    parameters: LuGre = LuGre()

    @property
    def law(self) -> Law:
        """What the law states."""
        return ALL[self.kind]

    @property
    def name(self) -> str:
        """The law's name."""
        return LAWS[self.kind]

    @property
    def bristle(self) -> bool:
        """Whether the arm moves a bristle before it slides; otherwise it truly sticks."""
        return BRISTLE[self.kind]

    def named(self, name: str) -> FrictionLaw:
        """The law of that name with the same parameters."""
        return self._replace(kind=LAWS.index(name))


def friction_law(name: str, parameters: LuGre) -> FrictionLaw:
    """The law of that name, one of :data:`LAWS`, with its parameters."""
    return FrictionLaw(LAWS.index(name), parameters)


@compiled
def has_bristle(law: FrictionLaw) -> bool:
    """Whether the arm moves a bristle before it slides."""
    return BRISTLE[law.kind]


@compiled
def symmetric_level(v: float, law: FrictionLaw) -> float:
    """Level [V] of the sliding arm at speed v [rad/s] before its asymmetry, viscous part apart."""
    return _level(law.kind, v, law.parameters)


@compiled
def sliding_level(v: float, direction: float, law: FrictionLaw) -> float:
    """Friction [V] opposing a motion at speed v [rad/s], viscous part apart.

    The sign of ``direction`` is given beside the speed because at v = 0 a slide that begins or ends
    has one.
    """
    return symmetric_level(v, law) * _factor(direction, law)


@compiled
def breakaway_level(direction: float, law: FrictionLaw) -> float:
    """Torque [V] up to which a resting arm is held against motion in ``direction`` (±1)."""
    return _breakaway(law.kind, law.parameters) * _factor(direction, law)


@compiled
def _factor(direction: float, law: FrictionLaw) -> float:
    """1 ± asymmetry. Two constants and a choice: no arithmetic waits for the direction."""
    asymmetry = law.parameters.asymmetry
    return 1.0 + asymmetry if direction >= 0.0 else 1.0 - asymmetry


@compiled
def steady_friction(v: float, law: FrictionLaw) -> float:
    """F [V] of the law at steady speed v [rad/s], viscous part included; 0 at v = 0."""
    if v == 0.0:
        return 0.0
    direction = 1.0 if v > 0.0 else -1.0
    return direction * sliding_level(v, direction, law) + law.parameters.viscous * v


@compiled
def friction_force(v: float, memory: float, law: FrictionLaw) -> float:
    """F [V] of the simulated arm at speed v [rad/s], viscous part included.

    ``memory`` is what the law keeps from step to step: the bristle's deflection [rad] or, of a
    law that truly sticks, the friction of the last step [V].
    """
    p = law.parameters
    if not BRISTLE[law.kind]:
        return memory + p.viscous * v
    level = sliding_level(v, v, law)
    return (
        p.sigma0 * memory
        + p.sigma1 * deflection_rate(v, abs(v), memory, level, p)
        + (p.viscous * v)
    )


@compiled
def bristle_force(v: float, z: float, h: float, law: FrictionLaw) -> tuple[float, float]:
    """Mean friction [V] of the bristle over ``h`` [s] at speed v [rad/s], viscous part apart.

    Exact for constant v. Returns it with the deflection at the end [rad].
    """
    p = law.parameters
    level = sliding_level(v, v, law)
    end, mean = deflection_after(v, 0.0, z, h, level, p)
    return p.sigma0 * mean + p.sigma1 / h * (end - z), end


@compiled
def sticking_force(v: float, before: float, holding: float, law: FrictionLaw) -> float:
    """Mean friction [V] over a step under a law that truly sticks, viscous part apart.

    ``holding`` [V] is what would bring the arm to rest at the end of the step, ``before`` the
    speed at its start [rad/s] and v that at which the law is evaluated. Friction brings the arm
    to rest, and keeps it there, if the level allows it; otherwise it is the level.
    """
    if abs(before) < STUCK:
        forward, backward = breakaway_level(1.0, law), breakaway_level(-1.0, law)
    else:
        forward, backward = sliding_level(v, 1.0, law), sliding_level(v, -1.0, law)
    return min(max(holding, -backward), forward)
