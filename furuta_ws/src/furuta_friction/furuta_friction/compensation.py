"""Friction compensation: the compensators, and one sample of the chosen one.

A compensator computes the friction estimate F̂ [V] from the state estimate. To add one, write its
file in ``compensators/`` and name it here: in :data:`ALL`, in :func:`estimate_friction`, and where
it has parameters, memory or design. A function of the user's own needs no file
(:mod:`furuta_model.own_functions`).
"""

from dataclasses import dataclass, field
from math import isnan, nan
from typing import Annotated, NamedTuple

import numpy as np

from furuta_friction import applied, disturbance_observer
from furuta_friction.compensators import (
    adaptive,
    bristle_observer,
    coulomb,
    own,
    predictive,
    stiction,
)
from furuta_friction.compensators.adaptive import Adaptive, AdaptiveMemory, AdaptiveParameters
from furuta_friction.compensators.bristle_observer import BristleMemory, Joint
from furuta_friction.compensators.own import OwnCompensation
from furuta_friction.compensators.predictive import Predictive, PredictiveMemory
from furuta_friction.disturbance_observer import (
    FASTER_THAN_FALL,
    LARGEST_STEP,
    Body,
    Observation,
    ObservationMemory,
    balancing_friction,
    least_bandwidth,
    limited,
    observe,
)
from furuta_friction.disturbance_observer import design as design_observation
from furuta_friction.learned_friction import LARGEST_LEVEL, LearningParameters
from furuta_model.compiled import inlined
from furuta_model.friction.lugre import highest_level
from furuta_model.friction.parameters import Friction
from furuta_model.late_drive import LateDrive
from furuta_model.linear import linearize
from furuta_model.own_functions import OwnMemory, forget_own, kind_and_address
from furuta_model.parameters import INLINE, SELECTS, About, designed_once
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import APPLIED_TORQUE, PHI, PHI_DOT


class Compensator(NamedTuple):
    """A compensator: its title, and whether it needs the observed friction."""

    name: str
    title: str
    meaning: str
    needs_observed_friction: bool = False


ALL = (
    Compensator("none", "None", "0 V"),
    Compensator("coulomb", "Coulomb", "Coulomb level with the sign of the speed, eq. (4)"),
    Compensator(
        "stiction",
        "Stiction",
        "Coulomb level while sliding, observed friction at rest",
        needs_observed_friction=True,
    ),
    Compensator("lugre", "LuGre observer", "LuGre observer, eq. (9)"),
    Compensator(
        "adaptive",
        "Adaptive LuGre observer",
        "LuGre observer with levels that follow the observed friction",
        needs_observed_friction=True,
    ),
    Compensator(
        "recommended",
        "Recommended",
        "friction of a learned level and presliding when the command acts, plus the observed rest",
        needs_observed_friction=True,
    ),
)
TITLES = {compensator.name: compensator.title for compensator in ALL}
COMPENSATIONS = tuple(TITLES)
# Kinds: places in the list, and one of the user's own.
NONE = COMPENSATIONS.index("none")
COULOMB = COMPENSATIONS.index("coulomb")
STICTION = COMPENSATIONS.index("stiction")
LUGRE = COMPENSATIONS.index("lugre")
ADAPTIVE = COMPENSATIONS.index("adaptive")
PREDICTIVE = COMPENSATIONS.index("recommended")
OWN = len(ALL)
# Value of ``running`` in the memory that is no kind plus 1.
NOT_RUNNING = 0
_MEANINGS = "; ".join(f"{compensator.name}: {compensator.meaning}" for compensator in ALL)


class ObserverParameters(NamedTuple):
    """Parameters of the node ``friction_observer``."""

    compensation: Annotated[str, About(_MEANINGS, choices=COMPENSATIONS, own=True)] = "none"
    friction: Annotated[Friction, INLINE] = Friction()
    observer_gain: Annotated[
        float, About("gain K by which the arm angle corrects the LuGre observer", "1/s", -1e3, 1e3)
    ] = 0.01
    bandwidth: Annotated[
        float,
        About(
            "bandwidth with which the friction is observed; what acts is at most "
            f"{LARGEST_STEP:g}/sample_time, and for recommended at least {FASTER_THAN_FALL:g} "
            "times the rate at which the pendulum falls",
            "1/s",
            0.01,
            1e4,
        ),
    ] = 50.0
    adaptive: Annotated[AdaptiveParameters, INLINE] = AdaptiveParameters()
    learning: Annotated[LearningParameters, INLINE] = LearningParameters()
    model: FurutaPendulum = FurutaPendulum()
    model_viscous: Annotated[
        float,
        About(
            "viscous friction of the arm in the model; the observed friction does not contain it",
            "V s/rad",
            0,
            100,
        ),
    ] = 0.0
    drive: LateDrive = LateDrive()
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
        return Compensator(self.compensation, self.compensation, "own")


class CompensationDesign(NamedTuple):
    """The compensation as :func:`estimate_friction` uses it; ``kind`` is an index of ALL or OWN.

    ``function`` is the address of an own compensator. Not every one ``observes`` the friction.
    """

    kind: Annotated[int, SELECTS]
    function: int
    observes: Annotated[bool, SELECTS]
    joint: Joint
    observation: Observation
    adaptive: Adaptive
    predictive: Predictive


@dataclass
class CompensationMemory:
    """What the compensators remember.

    ``running`` is the kind plus 1 of the one that runs, :data:`NOT_RUNNING` before it begins.
    """

    running: int = NOT_RUNNING
    bristle: BristleMemory = field(default_factory=BristleMemory)
    observation: ObservationMemory = field(default_factory=ObservationMemory)
    adaptive: AdaptiveMemory = field(default_factory=AdaptiveMemory)
    predictive: PredictiveMemory = field(default_factory=PredictiveMemory)
    own: OwnMemory = field(default_factory=OwnMemory)


@designed_once
def design_compensator(p: ObserverParameters) -> CompensationDesign:
    """The compensation that the parameters describe, for the arm of the pendulum."""
    a, b = linearize(p.model, p.model_viscous)
    return design_for_body(p, Body(a, b, p.drive, p.sample_time))


def design_for_body(p: ObserverParameters, body: Body) -> CompensationDesign:
    """The compensation that the parameters describe, for the joint of this body."""
    kind, function = kind_and_address(p.compensation, COMPENSATIONS, OwnCompensation)
    joint = Joint(p.friction, p.observer_gain, p.sample_time)
    level, acts = float(highest_level(p.friction)), kind == PREDICTIVE
    fast = limited(max(p.bandwidth, least_bandwidth(body)), body.dt)
    bandwidth = fast if acts else limited(p.bandwidth, body.dt)
    late_body, largest = predictive.assumed(body, fast), LARGEST_LEVEL * level
    seen = late_body if acts else body
    observed = design_observation(seen, bandwidth, largest, level, acts)
    return CompensationDesign(
        kind=kind,
        function=function,
        observes=p.chosen.needs_observed_friction or kind == OWN,
        joint=joint,
        observation=observed,
        adaptive=adaptive.design(joint, p.adaptive),
        predictive=predictive.design(p.friction, late_body, fast, observed, p.learning),
    )


@inlined
def reset(memory: CompensationMemory) -> None:
    """Begin anew with the next state, as the rig has been put back."""
    memory.running = NOT_RUNNING


@inlined
def begin(memory: CompensationMemory, x: np.ndarray, p: CompensationDesign) -> None:
    """Begin in state ``x`` (5,): at first, after a switch or a gap. Learned levels are kept."""
    memory.running = p.kind + 1
    friction = balancing_friction(x, p.observation)
    bristle_observer.begin(memory.bristle, x, friction, p.joint)
    disturbance_observer.begin(memory.observation, x)
    predictive.begin(memory.predictive, x, friction, p.predictive)
    forget_own(memory.own)


def beyond_adaptation(memory: np.ndarray, p: ObserverParameters) -> bool:
    """Whether the adaptive compensation is used outside its model; ``memory`` is a block."""
    return p.compensation == "adaptive" and adaptive.at_limit(memory["adaptive"][0])


def learned(memory: np.ndarray, design: np.ndarray) -> dict[str, str]:
    """What ``recommended`` knows of the friction; memory and design are blocks.

    Level [V] and presliding [rad], which is named at its limits; nothing if another one runs.
    """
    if memory["running"][0] != PREDICTIVE + 1:
        return {}
    found, learning = memory["predictive"]["learned"][0], design["predictive"]["learning"][0]
    x_s = found["presliding"]
    limits = {learning["smallest"]: " (its smallest)", learning["largest"]: " (its largest)"}
    return {
        "learned level": f"{found['level'] * learning['highest']:.4g}",
        "learned presliding": f"{x_s:.4g}{limits.get(x_s, '')}",
    }


@inlined
def estimate_friction(memory: CompensationMemory, x: np.ndarray, p: CompensationDesign) -> float:
    """F̂ [V] for the state estimate ``x`` (5,) with the applied torque; ``memory`` is updated.

    While the arm's state is unknown (NaN), F̂ is 0 V; then the compensator begins anew.
    """
    return continued_estimate(memory, x, p) if is_ready(memory, x, p) else 0.0


@inlined
def is_ready(memory: CompensationMemory, x: np.ndarray, p: CompensationDesign) -> bool:
    """Whether the state is known; if so, the compensator begins unless it continues."""
    if continues(memory, x, p):
        return True
    reset(memory)
    if isnan(x[PHI_DOT] + x[PHI]):
        return False
    begin(memory, x, p)
    return True


@inlined
def continues(memory: CompensationMemory, x: np.ndarray, p: CompensationDesign) -> bool:
    """Whether the chosen compensator has run in the sample before, and the state is known."""
    return (memory.running == p.kind + 1) & (not isnan(x[PHI_DOT] + x[PHI]))


@inlined
def continued_estimate(memory: CompensationMemory, x: np.ndarray, p: CompensationDesign) -> float:
    """F̂ [V] of a compensator that continues."""
    return compensate(memory, x, observe_friction(memory, x, p), p)


@inlined
def pass_missing(memory: CompensationMemory, x: np.ndarray, p: CompensationDesign) -> None:
    """Pass a sample that is missing, with the state ``x`` (5,) after it; F̂ has been held."""
    if not continues(memory, x, p):
        return
    observed = observe_friction(memory, x, p)
    if p.kind == PREDICTIVE:
        predictive.estimate(
            memory.predictive, memory.observation, x, observed, True, p.predictive, p.observation
        )
    else:
        compensate(memory, x, observed, p)


@inlined
def observe_friction(memory: CompensationMemory, x: np.ndarray, p: CompensationDesign) -> float:
    """What the compensator does not model of the friction that acts now [V].

    It is NaN if the compensator does not need it, or it cannot be observed.
    """
    if not p.observes:
        return nan
    if p.observation.acts:
        applied.learn(memory.observation.applied, x[APPLIED_TORQUE])
    return observe(memory.observation, x, p.observation)


@inlined
def compensate(  # noqa: PLR0911 (one for each compensator)
    memory: CompensationMemory, x: np.ndarray, observed: float, p: CompensationDesign
) -> float:
    """F̂ [V] of the chosen compensator, with what has been ``observed`` [V]."""
    if p.kind == NONE:
        return 0.0
    if p.kind == COULOMB:
        return coulomb.estimate(x, p.joint)
    if p.kind == STICTION:
        return stiction.estimate(x, observed, p.joint)
    if p.kind == LUGRE:
        return bristle_observer.estimate(memory.bristle, x, p.joint)
    if p.kind == ADAPTIVE:
        return adaptive.estimate(memory.bristle, memory.adaptive, x, observed, p.adaptive)
    if p.kind == PREDICTIVE:
        return predictive.estimate(
            memory.predictive, memory.observation, x, observed, False, p.predictive, p.observation
        )
    if p.kind == OWN:
        return own.estimate(memory.own, x, observed, p.function, p.adaptive)
    return nan
