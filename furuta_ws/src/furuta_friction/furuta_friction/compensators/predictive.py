r"""Compensation ``recommended``: a friction model at a predicted speed, and the rest.

.. math::
    \hat F = ρ\,m(z, v_p) + σ_2 v_p + r, \qquad
    \dot ρ = \frac{λ}{F_{max}}\,r\,\mathrm{sgn}\,v \ \text{ while the arm slides}

m is the friction of the LuGre observer at the speed v_p that is wanted when the command acts: that
of the linear model with the commands of the feedback alone (:mod:`furuta_model.late_drive`). While
the arm sticks, m so changes its sign when the feedback does, and not when the arm breaks away. r is
what the model lacks, observed in the present (:mod:`furuta_friction.disturbance_observer`).
The level ρ, relative to that of the friction parameters, is learned. It follows r where the arm has
slid in one direction for longer than a vibration does; it falls more slowly than it rises.

The lag of the drive is inverted for F̂, down to a shortest one; noise forbids more.
"""

from dataclasses import dataclass, field
from math import ceil, isnan
from typing import Annotated, NamedTuple

import numpy as np

from furuta_friction import applied, vibration
from furuta_friction.compensators import bristle_observer
from furuta_friction.compensators.bristle_observer import BristleMemory, Joint
from furuta_friction.disturbance_observer import Body, ObservationMemory
from furuta_friction.vibration import Vibration, VibrationMemory, allowed_share
from furuta_model.compiled import inlined
from furuta_model.friction.lugre import highest_level
from furuta_model.late_drive import (
    DriveMemory,
    Prediction,
    SampledDrive,
    acting_torque,
    assume_held,
    design_drive,
    design_prediction,
    predicted,
)
from furuta_model.parameters import About
from furuta_model.state import APPLIED_TORQUE, PHI, PHI_DOT

# Largest level, and largest F̂ without viscous friction, relative to the highest level of the
# friction parameters. The rest also holds against a push.
LARGEST_LEVEL, LARGEST_ESTIMATE = 4.0, 20.0
# While the rest alternates, F̂ is limited to a part of this, at least the smallest: else a pendulum
# could fall behind a late drive that is not known. It alternates by more than a multiple of the
# same level, and not more slowly than a frequency [Hz].
SMALLEST_PART, ALTERNATING_REST, SLOWEST_ALTERNATION = 0.3, 1.0, 1.0
SMALLEST_LEVEL = 1e-4
# Rate at which the level falls, relative to that at which it rises.
FALL = 0.25
# Part of the level from which the modelled friction counts as that of a sliding arm.
SLIDING = 0.8
# Times relative to that of the observer, the inverse of its bandwidth: for which the arm must have
# slid in one direction, by which the speed is predicted at least, to which a longer lag of the
# drive is reduced.
ONE_WAY, HORIZON, SHORTEST_LAG = 4.0, 1.0, 0.25
# Most by which the lag is divided: F̂ stays below twice that times its largest.
LARGEST_INVERSION = 8.0
# The same for the lag that is assumed at least: a drive of which less is known can be late too, and
# the assumption costs next to nothing where it is not.
ASSUMED_LAG = 0.4


@dataclass
class PredictiveMemory:
    """What the compensator remembers.

    Attributes:
        bristle: That of the model.
        level: Learned level, relative to that of the parameters.
        direction: Direction in which the arm slides, ±1; 0 before the first sample.
        one_way: Samples for which it has slid so.
        model_lag: Modelled friction behind the lag of the drive [V], for its inversion.
        sent_lag: F̂ behind the lag of the drive [V].
        feedback: What the drive has been given by the feedback alone.
        alternation: Memory of the detector of a rest that alternates.
    """

    bristle: BristleMemory = field(default_factory=BristleMemory)
    level: float = 1.0
    direction: float = 0.0
    one_way: int = 0
    model_lag: float = 0.0
    sent_lag: float = 0.0
    feedback: DriveMemory = field(default_factory=DriveMemory)
    alternation: VibrationMemory = field(default_factory=VibrationMemory)


class PredictiveParameters(NamedTuple):
    """Parameters of the compensator."""

    level_rate: Annotated[
        float, About("recommended: rate at which the level is learned", "1/s", 0.0, 1e3)
    ] = 8.0


class Predictive(NamedTuple):
    """The sampled compensator: highest level [V], change of ρ in a sample for a rest of 1 V.

    The lag is divided by ``inversion``.
    """

    joint: Joint
    level: float
    alternation: Vibration
    change: float
    one_way: int
    prediction: Prediction
    drive: SampledDrive
    inversion: float


def design(joint: Joint, body: Body, bandwidth: float, p: PredictiveParameters) -> Predictive:
    """The compensator for a joint and its body; the friction is observed with a bandwidth [1/s]."""
    level = float(highest_level(joint.friction))
    dt = joint.sample_time
    return Predictive(
        joint=joint,
        level=level,
        alternation=vibration.design(ALTERNATING_REST * level, dt, SLOWEST_ALTERNATION),
        change=p.level_rate * dt / level if level > 0.0 else 0.0,
        one_way=ceil(ONE_WAY / bandwidth / dt),
        prediction=design_prediction(body.a, body.b, body.drive, dt, HORIZON / bandwidth),
        drive=design_drive(body.drive, dt),
        inversion=min(max(body.drive.lag * bandwidth / SHORTEST_LAG, 1.0), LARGEST_INVERSION),
    )


def assumed(body: Body, bandwidth: float) -> Body:
    """The body whose drive is at least as late as is assumed."""
    drive = body.drive
    lag = max(drive.lag, ASSUMED_LAG / bandwidth - drive.delay * body.dt)
    return body._replace(drive=drive._replace(lag=lag))


@inlined
def estimate(
    memory: PredictiveMemory,
    observation: ObservationMemory,
    x: np.ndarray,
    observed: float,
    is_held: bool,
    p: Predictive,
) -> float:
    """F̂ [V] for the time when it acts; ``observed`` [V] is what the model lacks now.

    If that is NaN, the linear model does not hold, and F̂ is the modelled friction at the present
    speed. If the sample ``is_held``, the last F̂ is sent once more.
    """
    model, estimated = _due(memory, observation, x, observed, p)
    if is_held:
        model, estimated = observation.modelled_sent, observation.applied.sent[0]
    else:
        model = _ahead_of_lag(memory.model_lag, model, p)
        estimated = _ahead_of_lag(memory.sent_lag, estimated, p)
    memory.model_lag += p.drive.end_share * (model - memory.model_lag)
    memory.sent_lag += p.drive.end_share * (estimated - memory.sent_lag)
    observation.modelled_sent = model
    applied.remember(observation.applied, estimated)
    return estimated


@inlined
def _due(
    memory: PredictiveMemory,
    observation: ObservationMemory,
    x: np.ndarray,
    observed: float,
    p: Predictive,
) -> tuple[float, float]:
    """The modelled friction and all of it [V] when a command acts that is sent now."""
    fed_back = observation.fed_back
    acting_torque(memory.feedback, fed_back if not isnan(fed_back) else 0.0, p.drive)
    v, rest = x[PHI_DOT], 0.0
    friction = p.joint.friction
    part = SMALLEST_PART
    if not isnan(observed):
        part = max(allowed_share(memory.alternation, observed, p.alternation), part)
        _learn(memory, v, observed, p)
        rest = observed
        if observation.applied.believed != applied.NONE:
            v = predicted(memory.feedback, x, PHI_DOT, p.prediction)
    largest = LARGEST_ESTIMATE * part * p.level + friction.viscous * abs(x[PHI_DOT])
    dry = bristle_observer.dry_friction(memory.bristle, v, x[PHI], friction, p.joint)
    model = min(max(memory.level * dry + friction.viscous * v, -largest), largest)
    return model, min(max(model + rest, -largest), largest)


@inlined
def _ahead_of_lag(behind: float, due: float, p: Predictive) -> float:
    """What is sent so that ``behind`` the lag it follows what is due with a shorter one [V]."""
    return behind + p.inversion * (due - behind)


@inlined
def _learn(memory: PredictiveMemory, v: float, rest: float, p: Predictive) -> None:
    """Let the level follow the rest, where the arm slides at speed v in one direction."""
    direction = 1.0 if v > 0.0 else -1.0
    memory.one_way = memory.one_way + 1 if direction == memory.direction else 0
    memory.direction = direction
    slides = memory.model_lag * direction > SLIDING * memory.level * p.level
    if slides and memory.one_way >= p.one_way:
        change = p.change * rest * direction
        level = memory.level + (change if change > 0.0 else FALL * change)
        memory.level = min(max(level, SMALLEST_LEVEL), LARGEST_LEVEL)


@inlined
def begin(memory: PredictiveMemory, x: np.ndarray, force: float, p: Joint) -> None:
    """Begin in state ``x`` with a bristle under the ``force`` [V], and a torque held for long."""
    bristle_observer.begin(memory.bristle, x, force, p)
    memory.model_lag = memory.sent_lag = 0.0
    memory.one_way = 0
    torque = x[APPLIED_TORQUE]
    assume_held(memory.feedback, 0.0 if isnan(torque) else torque)
