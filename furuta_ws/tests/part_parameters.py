"""Parameters of parts by their own names, and the bound of every friction estimate."""

from math import inf
from typing import Any

from furuta_control.control import ControllerParameters
from furuta_control.modes.balance import BalanceParameters
from furuta_friction.compensation import ObserverParameters, design_compensator
from furuta_friction.compensators.predictive import LARGEST_ESTIMATE


def controller(**given: Any) -> ControllerParameters:
    """Parameters of a controller; those of the mode ``balance`` by their own names."""
    balance = {name: given.pop(name) for name in BalanceParameters._fields if name in given}
    return ControllerParameters(**given, balance=BalanceParameters(**balance))


def largest_estimate(v: float, p: ObserverParameters) -> float:
    """Upper limit of |F̂| [V] at speed v [rad/s], for any history."""
    friction, factor = p.friction, 3.0 if p.compensation == "adaptive" else 1.0
    level = (friction.alpha0 + friction.alpha1) * (1.0 + abs(friction.asymmetry))
    if p.compensation == "recommended":
        # The viscous part is that of a predicted speed.
        inverted = 2.0 * design_compensator(p).predictive.inversion - 1.0
        return inf if friction.viscous else inverted * LARGEST_ESTIMATE * level
    return factor * level + friction.viscous * abs(v)
