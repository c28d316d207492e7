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

from furuta_friction.compensators import adaptive, coulomb, stiction
from furuta_friction.compensators.adaptive import LARGEST_FACTOR
from furuta_friction.compensators.bristle_observer import BRISTLE, observe
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
)
NONE, COULOMB, STICTION, LUGRE, ADAPTIVE = range(5)

COMPENSATIONS = tuple(each.name for each in ALL)
_MEANINGS = "; ".join(f"{each.name}: {each.meaning}" for each in ALL)

# Size of the compensators' memory: ẑ of the observer, and the two factors of the adaptation.
MEMORY = 3


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
    sample_time: Annotated[
        float, About("time between state estimates", "s", 1e-5, 0.1, read_only=True)
    ] = 0.001

    @property
    def chosen(self) -> Compensation:
        """The compensation that the parameters select."""
        return ALL[COMPENSATIONS.index(self.compensation)]


class Compensator(NamedTuple):
    """The compensator as :func:`estimate_friction` uses it."""

    kind: int
    friction: Friction
    observer_gain: float
    adaptation_gain: float
    sample_time: float


def design_compensator(p: ObserverParameters) -> Compensator:
    """The compensator that the parameters describe."""
    return Compensator(
        COMPENSATIONS.index(p.compensation),
        p.friction,
        p.observer_gain,
        p.adaptation_gain,
        p.sample_time,
    )


@inlined
def start_anew(memory: np.ndarray) -> None:
    """Relax the bristle, as the rig has been put back. Levels that have adapted are kept."""
    memory[BRISTLE] = 0.0


@inlined
def estimate_friction(memory: np.ndarray, estimate: np.ndarray, p: Compensator) -> float:
    """F̂ [V] for the state estimate (5,); ``memory`` (MEMORY,) is updated.

    The observer runs with every compensation, so it has converged when the user switches to it.
    While the arm's state is unknown (NaN), F̂ is 0 V and the memory is kept.
    """
    v, observed = estimate[PHI_DOT], estimate[OBSERVED_FRICTION]
    if isnan(v + estimate[PHI]):
        return 0.0
    correction = -p.observer_gain * estimate[PHI]
    if p.kind == ADAPTIVE:
        return adaptive.estimate(
            memory, v, observed, correction, p.adaptation_gain, p.sample_time, p.friction
        )
    bristle = observe(memory, v, correction, p.sample_time, p.friction)
    if p.kind == LUGRE:
        return bristle
    if p.kind == STICTION:
        return stiction.estimate(v, observed, p.friction)
    if p.kind == COULOMB:
        return coulomb.estimate(v, p.friction)
    return 0.0


@compiled
def largest_estimate(v: float, p: Compensator) -> float:
    """Upper limit of |F̂| [V] at speed v [rad/s], for any history."""
    factor = LARGEST_FACTOR if p.kind == ADAPTIVE else 1.0
    return factor * highest_level(p.friction) + p.friction.viscous * abs(v)
