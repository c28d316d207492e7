r"""Friction of two learned numbers: the level ρ, and the presliding x_s over which it turns.

.. math::
    m = ρF_{max}(n + T_σ\dot n), \qquad
    \dot n = \frac{1}{x_s}\Bigl(v - \frac{F_{max}}{g(v)}|v|\,n\Bigr)

n, between −1 and 1, is the deflection of LuGre friction over its largest; σ₀ = ρF_max/x_s, and
σ₁ = T_σ σ₀. ρ is relative to the levels g of the friction parameters, whose highest is F_max.

**Level.** ρ follows what is observed beside m, r, where the joint has slid in one direction for
longer than a vibration does; it falls more slowly than it rises:

.. math::
    \dot ρ = \frac{λ}{F_{max}}\,r\,\mathrm{sgn}\,v

**Presliding.** Two bristles n₋ and n₊ follow the present speed, one shorter than x_s by a third and
one longer by half. T is the response of the observer of friction. It makes them as late as the
observed friction Tm + r, so x_s goes to where the mean of both is what is observed:

.. math::
    \dot{(\ln x_s)} = -\frac{μ\,e\,d}{(ρF_{max})^2 + e^2}, \qquad
    d = T\bigl(ρF_{max}(n_- - n_+)\bigr), \quad e = r - T\Bigl(ρF_{max}\frac{n_- + n_+}{2} - m\Bigr)

x_s lies between limits that follow from the natural frequency √(bF_max/x_s) of the body on the
bristle. What is slower than the observer is observed well without a model; what is faster than its
filter is not seen.
"""

from dataclasses import dataclass, field
from math import ceil, inf
from typing import Annotated, NamedTuple

from furuta_friction.compensators.bristle_observer import MOVED_BEFORE
from furuta_friction.disturbance_observer import (
    Observation,
    ResponseMemory,
    forget_response,
    respond,
)
from furuta_model.compiled import inlined
from furuta_model.friction.lugre import decay_fractions, highest_level, stribeck_level
from furuta_model.friction.parameters import Friction
from furuta_model.late_drive import DriveMemory, acting_torque, assume_held
from furuta_model.parameters import About

# Smallest and largest level, relative to that of the parameters; rate at which it falls, relative
# to that at which it rises; part of it from which the modelled friction is that of a sliding joint.
SMALLEST_LEVEL, LARGEST_LEVEL, FALL, SLIDING = 1e-4, 4.0, 0.25, 0.8
# Length of the longer of two bristles over x_s.
LONGER = 1.5
# Lowest and highest natural frequency of the body on the bristle, relative to the bandwidth. The
# speed of a joint is derived from positions; a faster bristle would chatter with their steps.
SLOWEST, FASTEST, FASTEST_OF_JOINT = 0.6, 4.0, 1.5
# Times relative to that of the observer, the inverse of its bandwidth: for which the joint must
# have slid in one direction, and T_σ.
ONE_WAY, DAMPING_TIME = 4.0, 0.5


@dataclass
class LearnedMemory:
    """What is remembered of the friction.

    Attributes:
        level: ρ.
        presliding: x_s [rad]; 0 before the first sample.
        direction: Direction in which the joint slides, ±1; 0 before the first sample.
        one_way: Samples for which it has slid so.
        shorter: n₋.
        longer: n₊.
        drive: What the drive has been given by the model.
        difference: d.
        of_both: Mean of both bristles without the model, as it would be observed.
    """

    level: float = 1.0
    presliding: float = 0.0
    direction: float = 0.0
    one_way: int = 0
    shorter: float = 0.0
    longer: float = 0.0
    drive: DriveMemory = field(default_factory=DriveMemory)
    difference: ResponseMemory = field(default_factory=ResponseMemory)
    of_both: ResponseMemory = field(default_factory=ResponseMemory)


class LearningParameters(NamedTuple):
    """How fast the friction is learned."""

    level_rate: Annotated[
        float, About("recommended: rate at which the level is learned", "1/s", 0.0, 1e3)
    ] = 8.0
    presliding_rate: Annotated[
        float,
        About(
            "recommended: rate at which the presliding is learned, from that of the parameters",
            "1/s",
            0.0,
            1e3,
        ),
    ] = 5.0


class Learning(NamedTuple):
    """The sampled design.

    ``highest`` is F_max [V], ``first``, ``smallest`` and ``largest`` are values of x_s [rad]. The
    changes are those of ρ for a rest of 1 V, and of ln x_s, in a sample of ``dt`` [s]; T_σ is in s.
    """

    friction: Friction
    highest: float
    first: float
    smallest: float
    largest: float
    level_change: float
    presliding_change: float
    one_way: int
    damping_time: float
    dt: float


def design(friction: Friction, seen: Observation, p: LearningParameters) -> Learning:
    """What is learned of a friction that is observed."""
    highest, dt, bandwidth = float(highest_level(friction)), seen.dt, seen.bandwidth
    unit = highest * seen.b / bandwidth**2
    fastest = FASTEST_OF_JOINT if seen.valid_angle == inf else FASTEST
    smallest, largest = unit / fastest**2, unit / SLOWEST**2
    first = highest / friction.sigma0
    return Learning(
        friction=friction,
        highest=highest,
        first=min(max(first, smallest), largest) if p.presliding_rate and unit else first,
        smallest=smallest,
        largest=largest,
        level_change=p.level_rate * dt / highest,
        presliding_change=p.presliding_rate * dt,
        one_way=ceil(ONE_WAY / bandwidth / dt),
        damping_time=DAMPING_TIME / bandwidth,
        dt=dt,
    )


@inlined
def learn(
    memory: LearnedMemory,
    v: float,
    modelled: float,
    rest: float,
    part: float,
    p: Learning,
    seen: Observation,
) -> None:
    """Let level and presliding follow the observed friction.

    Args:
        memory: What is remembered.
        v: Speed of the joint [rad/s].
        modelled: Modelled friction that has been sent since the sample before [V].
        rest: What is observed beside it [V], with a ``part`` of the bandwidth.
        part: That part.
        p: The design.
        seen: That of the observer.
    """
    acting = acting_torque(memory.drive, modelled, seen.drive)
    _learn_presliding(memory, v, acting, rest, part, p, seen)
    direction = 1.0 if v > 0.0 else -1.0
    memory.one_way = memory.one_way + 1 if direction == memory.direction else 0
    memory.direction = direction
    slides = acting * direction > SLIDING * memory.level * p.highest
    if slides and memory.one_way >= p.one_way:
        change = p.level_change * rest * direction
        level = memory.level + (change if change > 0.0 else FALL * change)
        memory.level = min(max(level, SMALLEST_LEVEL), LARGEST_LEVEL)


@inlined
def _learn_presliding(
    memory: LearnedMemory,
    v: float,
    acting: float,
    rest: float,
    part: float,
    p: Learning,
    seen: Observation,
) -> None:
    x_s = memory.presliding
    level, highest = stribeck_level(v, p.friction) / p.highest, memory.level * p.highest
    memory.shorter = turned(memory.shorter, v, level, x_s / LONGER, p.dt)
    memory.longer = turned(memory.longer, v, level, x_s * LONGER, p.dt)
    mean = 0.5 * highest * (memory.shorter + memory.longer) - acting
    d = respond(memory.difference, highest * (memory.shorter - memory.longer), part, seen)
    e = rest - respond(memory.of_both, mean, part, seen)
    x_s *= 1.0 - p.presliding_change * e * d / (highest * highest + e * e)
    learns = p.presliding_change > 0.0
    memory.presliding = min(max(x_s, p.smallest), p.largest) if learns else p.first


@inlined
def turned(n: float, v: float, level: float, x_s: float, dt: float) -> float:
    """A bristle n that has moved at speed v for ``dt`` [s]: the exact solution.

    ``level`` is g(v)/F_max.
    """
    d, decay = dt / x_s, abs(v) / level
    return n + d * (v - decay * n) * decay_fractions(d * decay)[0]


@inlined
def moved(memory: LearnedMemory, n: float, v: float, p: Learning) -> tuple[float, float]:
    """The bristle n after a sample at speed v, and its friction m [V] without viscous friction."""
    level = stribeck_level(v, p.friction) / p.highest
    n = turned(n, v, level, memory.presliding, p.dt)
    rate = (v - abs(v) / level * n) / memory.presliding
    dry = min(max(n + p.damping_time * rate, -1.0), 1.0)
    return n, memory.level * p.highest * dry


@inlined
def begin(memory: LearnedMemory, v: float, force: float, p: Learning) -> float:
    """Begin at speed v; the bristle n that has had the ``force`` [V], and then moved so."""
    if memory.presliding == 0.0 or p.presliding_change == 0.0:
        memory.presliding = p.first
    memory.one_way = 0
    forget(memory)
    n = (force - p.friction.viscous * v) / (memory.level * p.highest)
    level = stribeck_level(v, p.friction) / p.highest
    return turned(min(max(n, -1.0), 1.0), v, level, memory.presliding, MOVED_BEFORE)


@inlined
def forget(memory: LearnedMemory) -> None:
    """Observe anew with the next sample; what has been learned is kept."""
    memory.shorter = memory.longer = 0.0
    assume_held(memory.drive, 0.0)
    forget_response(memory.difference)
    forget_response(memory.of_both)
