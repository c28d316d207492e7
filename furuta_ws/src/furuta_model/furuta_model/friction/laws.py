"""Registry of the friction laws, and their one interface for compiled code.

============  ============================================  =====================
law           sliding, v ≠ 0                                breaks away beyond
============  ============================================  =====================
coulomb       α₀ sgn v, eq. (4)                             α₀
stiction      α₀ sgn v                                      α₀ + α₁
stribeck      g(v) sgn v, g(v) = α₀ + α₁ exp(−(v/vs)²)      α₀ + α₁
lugre         bristle dynamics, eq. (5); at steady speed    (none: it creeps)
              that of stribeck
dahl          eq. (5) with σ₁ = 0 and g(v) = α₀             (none: it creeps)
maxwell_slip  springs, :mod:`.maxwell_slip`                 (none)
============  ============================================  =====================

Each law adds the viscous part σ₂v and the factor 1 ± asymmetry by direction. Dahl friction depends
on the path alone, not on the speed along it. It is Dahl's model with exponent 1 (P. R. Dahl, *A
solid friction model*, The Aerospace Corporation, 1968). To add a law, add it to :mod:`.names` and
here, or give a function (:mod:`furuta_model.own_functions`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, NamedTuple

import numba

from furuta_model.accepted_parts import accepted_part
from furuta_model.compiled import inlined
from furuta_model.friction.law import Law
from furuta_model.friction.levels import (
    copied,
    coulomb_level,
    direction_factor,
    static_level,
    stribeck_curve,
)
from furuta_model.friction.lugre import force, stretched
from furuta_model.friction.names import ANALYSED_LAWS, LAWS
from furuta_model.friction.parameters import Friction
from furuta_model.own_functions import address_of, call_own, own_function
from furuta_model.parameters import SELECTS, ParameterError

_STRIBECK = Law("stribeck", stribeck_curve)
_LISTED = (
    Law("coulomb", coulomb_level, constant=True),
    Law("stiction", coulomb_level, static_level, constant=True),
    _STRIBECK,
    _STRIBECK._replace(name="lugre", bristle=True),
    Law("dahl", coulomb_level, bristle=True, damped=False, constant=True),
    _STRIBECK._replace(name="maxwell_slip", bristle=True, damped=False, springs=True),
)
_BY_NAME = {law.name: law for law in _LISTED}
ALL = tuple(_BY_NAME[name] for name in LAWS)
# Kinds: places in the list, and one of the user's own.
COULOMB = LAWS.index("coulomb")
STICTION = LAWS.index("stiction")
LUGRE = LAWS.index("lugre")
DAHL = LAWS.index("dahl")
OWN = len(LAWS)
# Speed [rad/s] below which the arm counts as at rest under a law without bristle.
ZERO_SPEED = 1e-9
# Largest parameter of a joint in units of its own, such as N, m and s.
LARGEST = 1e12
# The paper's parameters.
PAPER = Friction()


class FrictionLaw(NamedTuple):
    """A law (index into :data:`LAWS`) with its parameters, for compiled code; by default LuGre.

    ``level`` and ``breakaway`` are the addresses of an own law's functions. With ``bristle`` the
    arm moves a bristle before it slides, or ``springs``; otherwise it truly sticks.
    """

    kind: Annotated[int, SELECTS] = LUGRE
    parameters: Friction = PAPER
    level: int = 0
    breakaway: int = 0
    bristle: Annotated[bool, SELECTS] = True
    springs: Annotated[bool, SELECTS] = False

    @property
    def law(self) -> Law:
        """The law itself."""
        return ALL[self.kind] if self.kind < OWN else _own_laws[self.level, self.breakaway]

    @property
    def name(self) -> str:
        """The law's name."""
        return self.law.name

    def named(self, name: str) -> FrictionLaw:
        """The law with this name and the same parameters."""
        return friction_law(name, self.parameters)


def friction_law(name: str, parameters: Friction = PAPER) -> FrictionLaw:
    """The law with this name, one of :data:`LAWS` or an own one, and these parameters.

    A law without damping has σ₁ = 0, whatever is given.
    """
    law = find_law(name)
    if not law.damped:
        parameters = parameters._replace(sigma1=0.0)
    kind, addresses = (LAWS.index(name), (0, 0)) if name in LAWS else (OWN, _addresses(law))
    return FrictionLaw(kind, parameters, *addresses, law.bristle, law.springs)


def find_law(name: str) -> Law:
    """The law with this name, one of :data:`LAWS` or an own one (``module:function``)."""
    if name in LAWS:
        return ALL[LAWS.index(name)]
    part = accepted_part(name)
    law = part._replace(name=name) if isinstance(part, Law) else Law(name, own_function(name))
    _own_laws[_addresses(law)] = law
    return law


_own_laws: dict[tuple[int, int], Law] = {}


def _addresses(law: Law) -> tuple[int, int]:
    """Addresses of the level and of the breakaway level of an own law."""
    parameters = numba.typeof(Friction())
    level = address_of(law.level, numba.float64, parameters)
    if law.breakaway is None:
        return level, address_of(law.level, parameters, entry=_level_at_rest)
    return level, address_of(law.breakaway, parameters)


def _level_at_rest(level: Callable[[float, Friction], float]) -> Callable[[Friction], float]:
    """The breakaway level of a law that has none of its own: g(0)."""
    return lambda p: level(0.0, p)


def falls(name: str) -> bool:
    """Whether the level of a law of :data:`LAWS` falls over its Stribeck velocity."""
    return name in LAWS and not find_law(name).constant


def check_friction(name: str, p: Friction) -> None:
    """Reject parameters that friction of this law cannot have, in units of its own.

    Raises:
        ParameterError: A parameter is negative, not finite or too large, the asymmetry is not
            within ±1, there is no such law, or a parameter that it divides by is 0.
    """
    for parameter, value in p._asdict().items():
        low, high = (-1.0, 1.0) if parameter == "asymmetry" else (0.0, LARGEST)
        if not low <= value <= high:
            raise ParameterError(f"{parameter} must be {low:g} to {high:g}, given {value:g}")
    needed = {"sigma0": find_law(name).bristle, "stribeck_velocity": falls(name)}
    for parameter, divides in needed.items():
        if divides and getattr(p, parameter) == 0.0:
            raise ParameterError(f"friction of the law {name} needs {parameter} above 0")


def analysed_law(name: str, parameters: Friction) -> FrictionLaw:
    """The law, for analysis: raises :class:`ParameterError` where analysis is not defined."""
    if name in LAWS and name not in ANALYSED_LAWS:
        raise ParameterError(
            f"limit cycles and describing functions are not defined for the friction law {name}; "
            f"give --law with one of {', '.join(ANALYSED_LAWS)}, or simulate"
        )
    return friction_law(name, parameters)


@inlined
def symmetric_level(v: float, law: FrictionLaw) -> float:
    """Level [V] at sliding speed v [rad/s], without asymmetry and viscous part."""
    if law.kind == OWN:
        return call_own(law.level, (v, copied(law.parameters)))
    if law.kind == COULOMB or law.kind == STICTION or law.kind == DAHL:  # noqa: PLR1714 (C export)
        return coulomb_level(v, law.parameters)
    return stribeck_curve(v, law.parameters)


@inlined
def sliding_level(v: float, direction: float, law: FrictionLaw) -> float:
    """Friction [V] that opposes a slide at speed v [rad/s], without viscous part.

    The sign of ``direction`` is given separately, because a slide that begins or ends at v = 0
    also has a direction.
    """
    return symmetric_level(v, law) * direction_factor(direction, law.parameters)


@inlined
def breakaway_level(direction: float, law: FrictionLaw) -> float:
    """Torque [V] up to which a stuck arm is held against motion in ``direction`` (±1)."""
    factor = direction_factor(direction, law.parameters)
    if law.kind == OWN:
        return call_own(law.breakaway, (copied(law.parameters),)) * factor
    if law.kind == STICTION:
        return static_level(law.parameters) * factor
    return symmetric_level(0.0, law) * factor


@inlined
def steady_friction(v: float, law: FrictionLaw) -> float:
    """F [V] at steady speed v [rad/s], with viscous part; 0 at v = 0."""
    if v == 0.0:
        return 0.0
    direction = 1.0 if v > 0.0 else -1.0
    return direction * sliding_level(v, direction, law) + law.parameters.viscous * v


@inlined
def friction_force(v: float, memory: float, law: FrictionLaw) -> float:
    """F [V] of the simulated arm at speed v [rad/s], with viscous part.

    ``memory`` is the state of the law: the deflection of the bristle [rad], or the friction of the
    last step [V] for a law that truly sticks.
    """
    if not law.bristle:
        return memory + law.parameters.viscous * v
    return force(v, memory, sliding_level(v, v, law), law.parameters)


@inlined
def bristle_force(v: float, z: float, h: float, law: FrictionLaw) -> tuple[float, float]:
    """Mean friction [V] of the bristle over ``h`` [s] at speed v [rad/s], without viscous part.

    Exact for constant v. Also returns the deflection at the end [rad].
    """
    p = law.parameters
    end, mean, mean_rate = stretched(v, v, z, h, sliding_level(v, v, law), p)
    return p.sigma0 * mean + p.sigma1 * mean_rate, end


@inlined
def sticking_force(v: float, start_speed: float, holding: float, law: FrictionLaw) -> float:
    """Mean friction [V] over a step under a law that truly sticks, without viscous part.

    ``holding`` [V] is the friction that would bring the arm to rest at the end of the step,
    ``start_speed`` is the speed at its start [rad/s], and the law is evaluated at speed v. Friction
    brings the arm to rest and keeps it there if the level is high enough; otherwise it is the
    level.
    """
    if abs(start_speed) < ZERO_SPEED:
        forward, backward = breakaway_level(1.0, law), breakaway_level(-1.0, law)
    else:
        forward, backward = sliding_level(v, 1.0, law), sliding_level(v, -1.0, law)
    return min(max(holding, -backward), forward)
