"""Friction compensation: the registry of compensators and one sample of any of them.

A compensator computes the friction estimate F̂ [V] from the state estimate. To add one, write its
file in ``compensators/`` and add it to :data:`FILES`; its parameters, memory and design stand in
its file. A function of the user's own needs no file here (:mod:`furuta_model.own_functions`).
"""

from dataclasses import dataclass, field
from math import inf, isnan
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, TypeAlias

import numpy as np

from furuta_friction.compensator import Compensator
from furuta_friction.compensators import adaptive, bristle_observer, own
from furuta_friction.compensators.own import OwnCompensation
from furuta_model.compiled import by_kind, compiled, inlined
from furuta_model.friction.lugre import highest_level
from furuta_model.friction.parameters import Friction
from furuta_model.own_functions import OwnMemory, forget_own, own_part, sample_function
from furuta_model.parameters import INLINE, SELECTS, About
from furuta_model.registry import design_parts, designed_once, groups_of, in_turn, parts_in
from furuta_model.state import PHI, PHI_DOT

FILES = (
    "none",
    "coulomb",
    "stiction",
    "bristle_observer",
    "adaptive",
    "disturbance_observer",
    "combined",
)

ALL: tuple[Compensator, ...] = parts_in("furuta_friction.compensators", FILES)
COMPENSATIONS = tuple(compensator.name for compensator in ALL)
_MEANINGS = "; ".join(f"{compensator.name}: {compensator.meaning}" for compensator in ALL)
# Kind of a compensator of the user's own.
_OWN = len(ALL)
compensate = by_kind([*(compensator.estimate for compensator in ALL), own.estimate])
_reset_parts = in_turn(compensator.reset for compensator in ALL if compensator.reset is not None)

if TYPE_CHECKING:
    CompensatorParameters: TypeAlias = Any
    CompensatorMemories: TypeAlias = Any
    CompensatorDesigns: TypeAlias = Any
else:
    CompensatorParameters, CompensatorMemories, CompensatorDesigns = groups_of(
        ALL, __name__, "Compensator"
    )


class ObserverParameters(NamedTuple):
    """Parameters of the node ``friction_observer``."""

    compensation: Annotated[str, About(_MEANINGS, choices=COMPENSATIONS, own=True)] = "none"
    friction: Annotated[Friction, INLINE] = Friction()
    observer_gain: Annotated[
        float, About("gain K by which the arm angle corrects the LuGre observer", "1/s", -1e3, 1e3)
    ] = 0.01
    parts: Annotated[CompensatorParameters, INLINE] = CompensatorParameters()
    sample_time: Annotated[
        float, About("time between state estimates", "s", 1e-5, 0.1, read_only=True)
    ] = 0.001

    def check(self) -> None:
        """Reject an own compensator that cannot be compiled."""
        design_compensator(self)

    @property
    def chosen(self) -> Compensator:
        """The compensator that the parameters select."""
        if self.compensation in COMPENSATIONS:
            return ALL[COMPENSATIONS.index(self.compensation)]
        return own_part(self.compensation, Compensator, "own")


class CompensationDesign(NamedTuple):
    """The compensation as :func:`estimate_friction` uses it; ``kind`` is an index of ALL.

    ``function`` is the address of an own compensator.
    """

    kind: Annotated[int, SELECTS]
    function: int
    runs_observer: Annotated[bool, SELECTS]
    largest_factor: float
    friction: Friction
    observer_gain: float
    parts: CompensatorDesigns
    sample_time: float


@dataclass
class CompensationMemory:
    """What the compensators remember; ``bristle`` is ẑ of the observer [rad]."""

    bristle: float = 0.0
    parts: CompensatorMemories = field(default_factory=CompensatorMemories)
    own: OwnMemory = field(default_factory=OwnMemory)


@designed_once
def design_compensator(p: ObserverParameters) -> CompensationDesign:
    """The compensation that the parameters describe."""
    chosen, is_own = p.chosen, p.compensation not in COMPENSATIONS
    return CompensationDesign(
        kind=_OWN if is_own else COMPENSATIONS.index(p.compensation),
        function=sample_function(chosen.estimate, OwnCompensation) if is_own else 0,
        runs_observer=chosen.runs_observer and not is_own,
        largest_factor=inf if is_own else chosen.largest_factor,
        friction=p.friction,
        observer_gain=p.observer_gain,
        parts=CompensatorDesigns(*design_parts(ALL, p)),
        sample_time=p.sample_time,
    )


@inlined
def reset(memory: CompensationMemory) -> None:
    """Relax the bristle, as the rig has been put back. Levels that have adapted are kept."""
    memory.bristle = 0.0
    _reset_parts(memory)
    forget_own(memory.own)


def beyond_adaptation(memory: np.ndarray, p: ObserverParameters) -> bool:
    """Whether the adaptive compensation is used outside its model; ``memory`` is a block."""
    return p.chosen is adaptive.PART and adaptive.at_limit(memory["parts"]["adaptive"][0])


@inlined
def estimate_friction(memory: CompensationMemory, x: np.ndarray, p: CompensationDesign) -> float:
    """F̂ [V] for the state estimate ``x`` (5,); ``memory`` is updated.

    The observer runs with every compensation, so it has converged when the user switches to it.
    While the arm's state is unknown (NaN), F̂ is 0 V and the memory is kept.
    """
    if isnan(x[PHI_DOT] + x[PHI]):
        return 0.0
    if not p.runs_observer:
        bristle_observer.estimate(memory, x, p)
    return compensate(p.kind, memory, x, p)


@compiled
def largest_estimate(v: float, p: CompensationDesign) -> float:
    """Upper limit of |F̂| [V] at speed v [rad/s], for any history."""
    return p.largest_factor * highest_level(p.friction) + p.friction.viscous * abs(v)
