"""Friction compensation: the registry of compensators and one sample of any of them.

A compensator computes the friction estimate F̂ [V] from the state estimate. The observed friction is
the estimator's, from applied torque and motion; it is NaN if the estimator does not observe
friction. To add a compensator, write its file in ``compensators/`` and add it here: a row of
:data:`ALL`, its parameters if it has any, and its branch in :func:`estimate_friction`.
"""

from __future__ import annotations

from math import isnan
from typing import Annotated, NamedTuple

import numpy as np

from furuta_friction import guard
from furuta_friction.compensators import (
    adaptive,
    combined,
    coulomb,
    disturbance_observer,
    stiction,
)
from furuta_friction.compensators.adaptive import LARGEST_FACTOR
from furuta_friction.compensators.bristle_observer import BRISTLE, observe
from furuta_friction.compensators.combined import Combined
from furuta_friction.guard import Guard, guarded
from furuta_model.compiled import compiled, inlined
from furuta_model.friction.lugre import highest_level
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import INLINE, About
from furuta_model.state import OBSERVED_FRICTION, PHI, PHI_DOT


class Compensation(NamedTuple):
    """A compensator's name and meaning, and whether it needs the observed friction."""

    name: str
    meaning: str
    needs_observed_friction: bool = False


ALL = (
    Compensation("none", "0 V"),
    Compensation("coulomb", "eq. (4) with level alpha0"),
    Compensation("stiction", "that; at rest the observed friction", needs_observed_friction=True),
    Compensation("lugre", "the observer (9)"),
    Compensation("adaptive", "the same with levels that adapt", needs_observed_friction=True),
    Compensation("disturbance_observer", "the observed friction", needs_observed_friction=True),
    Compensation("combined", "that, with levels that are learned", needs_observed_friction=True),
)
NONE, COULOMB, STICTION, LUGRE, ADAPTIVE, DISTURBANCE_OBSERVER, COMBINED = range(7)

COMPENSATIONS = tuple(each.name for each in ALL)
_MEANINGS = "; ".join(f"{each.name}: {each.meaning}" for each in ALL)

# Size of the compensators' memory: ẑ of the observer, the two factors of the adaptation, two levels
# and the rest of the combined compensation; then the guard's.
GUARD = combined.REST + 1
MEMORY = GUARD + guard.MEMORY


class ObserverParameters(NamedTuple):
    """Parameters of the node ``friction_observer``."""

    compensation: Annotated[str, About(_MEANINGS, choices=COMPENSATIONS)] = "none"
    friction: Annotated[Friction, INLINE] = Friction()
    observer_gain: Annotated[
        float, About("correction gain K of the observer on the arm angle", "1/s", -1e3, 1e3)
    ] = 0.01
    adaptation_gain: Annotated[
        float, About("adaptive: rate at which a level adapts while the arm slides", "1/s", 0, 1e3)
    ] = 20.0
    combined: combined.CombinedParameters = combined.CombinedParameters()
    guard_time: Annotated[
        float, About("time after which a compensation worse than none ends, 0: never", "s", 0, 1e3)
    ] = 2.0
    sample_time: Annotated[
        float, About("time between state estimates", "s", 1e-5, 0.1, read_only=True)
    ] = 0.001

    @property
    def chosen(self) -> Compensation:
        """The compensation that the parameters select."""
        return ALL[COMPENSATIONS.index(self.compensation)]

    @property
    def switch_off_reason(self) -> str:
        """What to tell the user when the guard has switched the compensation off."""
        return (
            f"compensation {self.compensation} is switched off: for {self.guard_time:g} s it gave "
            "the arm more than twice the power that friction takes, which is worse than none. "
            "Either the estimate of the friction is too large, or it is too late: a delay or a "
            "slow estimator does that too. Changing a parameter tries it again"
        )


class Compensator(NamedTuple):
    """The compensator as :func:`estimate_friction` uses it."""

    kind: int
    friction: Friction
    observer_gain: float
    adaptation_gain: float
    combined: Combined
    guard: Guard
    sample_time: float


def design_compensator(p: ObserverParameters) -> Compensator:
    """The compensator that the parameters describe."""
    return Compensator(
        COMPENSATIONS.index(p.compensation),
        p.friction,
        p.observer_gain,
        p.adaptation_gain,
        combined.design(p.combined, p.sample_time),
        guard.design(p.guard_time, p.sample_time),
        p.sample_time,
    )


@inlined
def reset(memory: np.ndarray) -> None:
    """Relax the bristle, as the rig has been put back. Levels that have adapted are kept."""
    memory[BRISTLE] = 0.0
    memory[combined.REST] = 0.0
    allow(memory)


@inlined
def allow(memory: np.ndarray) -> None:
    """Allow a compensation that the guard has switched off: a parameter has been changed."""
    guard.forget(memory, GUARD)


def switched_off(memory: np.ndarray) -> bool:
    """Whether the guard has switched the compensation off."""
    return bool(memory[GUARD + guard.TRIPPED] != 0.0)


def beyond_adaptation(memory: np.ndarray, p: ObserverParameters) -> bool:
    """Whether the adaptive compensation is used outside its model."""
    return p.compensation == ALL[ADAPTIVE].name and adaptive.at_limit(memory)


@inlined
def estimate_friction(memory: np.ndarray, estimate: np.ndarray, p: Compensator) -> float:
    """F̂ [V] for the state estimate (5,); ``memory`` (MEMORY,) is updated.

    The observer runs with every compensation, so it has converged when the user switches to it.
    While the arm's state is unknown (NaN), F̂ is 0 V and the memory is kept.
    """
    if isnan(estimate[PHI_DOT] + estimate[PHI]):
        return 0.0
    if p.kind not in (LUGRE, ADAPTIVE):
        _observe(memory, estimate, p)
    return estimate_without_switch(memory, estimate, p)


@inlined
def estimate_without_switch(memory: np.ndarray, estimate: np.ndarray, p: Compensator) -> float:
    """:func:`estimate_friction` if the compensation never changes: no idle observer runs."""
    if isnan(estimate[PHI_DOT] + estimate[PHI]):
        return 0.0
    friction = _estimate(memory, estimate, p)
    return guarded(memory, GUARD, estimate, friction, p.guard) if p.kind != NONE else friction


@inlined
def _observe(memory: np.ndarray, estimate: np.ndarray, p: Compensator) -> float:
    """F̂ [V] of the observer (9)."""
    correction = -p.observer_gain * estimate[PHI]
    return observe(memory, estimate[PHI_DOT], correction, p.sample_time, p.friction)


@inlined
def _estimate(memory: np.ndarray, estimate: np.ndarray, p: Compensator) -> float:
    """F̂ [V] of the chosen compensation."""
    v, observed = estimate[PHI_DOT], estimate[OBSERVED_FRICTION]
    if p.kind == ADAPTIVE:
        correction = -p.observer_gain * estimate[PHI]
        return adaptive.estimate(
            memory, v, observed, correction, p.adaptation_gain, p.sample_time, p.friction
        )
    if p.kind == LUGRE:
        return _observe(memory, estimate, p)
    if p.kind == STICTION:
        return stiction.estimate(v, observed, p.friction)
    if p.kind == COULOMB:
        return coulomb.estimate(v, p.friction)
    if p.kind == NONE or isnan(observed):
        return 0.0
    return _observed(memory, v, observed, p)


@inlined
def _observed(memory: np.ndarray, v: float, observed: float, p: Compensator) -> float:
    """F̂ [V] of the compensations that follow the observed friction."""
    limit = LARGEST_FACTOR * highest_level(p.friction)
    if p.kind == COMBINED:
        return combined.estimate(memory, v, observed, limit, p.friction.viscous, p.combined)
    return disturbance_observer.estimate(v, observed, limit, p.friction.viscous)


@compiled
def largest_estimate(v: float, p: Compensator) -> float:
    """Upper limit of |F̂| [V] at speed v [rad/s], for any history."""
    factor = LARGEST_FACTOR if p.kind >= ADAPTIVE else 1.0
    return factor * highest_level(p.friction) + p.friction.viscous * abs(v)
