r"""Compensation ``recommended``: a friction model at a predicted speed, and the rest.

.. math::
    \hat F = m(v_p) + σ_2 v_p + r

m is friction whose level and presliding are learned (:mod:`furuta_friction.learned_friction`), at
the speed v_p that is wanted when the command acts: that of the linear model with the commands of
the feedback alone (:mod:`furuta_model.late_drive`). While the arm sticks, m so changes its sign
when the feedback does, and not when the arm breaks away. r is what the model lacks, observed in the
present (:mod:`furuta_friction.disturbance_observer`).

The lag of the drive is inverted for F̂, down to a shortest one; noise forbids more.
"""

from dataclasses import dataclass, field
from math import isnan
from typing import NamedTuple

import numpy as np

from furuta_friction import applied, learned_friction, vibration
from furuta_friction.disturbance_observer import Body, Observation, ObservationMemory
from furuta_friction.learned_friction import LearnedMemory, Learning, LearningParameters, moved
from furuta_friction.vibration import Vibration, VibrationMemory, allowed_share
from furuta_model.compiled import inlined
from furuta_model.friction.parameters import Friction
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
from furuta_model.state import APPLIED_TORQUE, PHI_DOT

# Largest F̂ without viscous friction, relative to the highest level of the friction parameters. The
# rest also holds against a push.
LARGEST_ESTIMATE = 20.0
# While the rest alternates, F̂ is limited to a part of this, at least the smallest: else a pendulum
# could fall behind a late drive that is not known. It alternates by more than a multiple of the
# same level, and not more slowly than a frequency [Hz].
SMALLEST_PART, ALTERNATING_REST, SLOWEST_ALTERNATION = 0.3, 1.0, 1.0
# Times relative to that of the observer, the inverse of its bandwidth: by which the speed is
# predicted at least, to which a longer lag of the drive is reduced.
HORIZON, SHORTEST_LAG = 1.0, 0.25
# Most by which the lag is divided: F̂ stays below twice that times its largest.
LARGEST_INVERSION = 8.0
# The same for the lag that is assumed at least: a drive of which less is known can be late too, and
# the assumption costs next to nothing where it is not.
ASSUMED_LAG = 0.4


@dataclass
class PredictiveMemory:
    """What the compensator remembers.

    Attributes:
        bristle: That of the model, from -1 to 1.
        learned: What is known of the friction.
        model_lag: Modelled friction behind the lag of the drive [V], for its inversion.
        sent_lag: F̂ behind the lag of the drive [V].
        feedback: What the drive has been given by the feedback alone.
        alternation: Memory of the detector of a rest that alternates.
    """

    bristle: float = 0.0
    learned: LearnedMemory = field(default_factory=LearnedMemory)
    model_lag: float = 0.0
    sent_lag: float = 0.0
    feedback: DriveMemory = field(default_factory=DriveMemory)
    alternation: VibrationMemory = field(default_factory=VibrationMemory)


class Predictive(NamedTuple):
    """The sampled compensator; the lag is divided by ``inversion``."""

    learning: Learning
    alternation: Vibration
    prediction: Prediction
    drive: SampledDrive
    inversion: float


def design(
    friction: Friction, body: Body, bandwidth: float, seen: Observation, p: LearningParameters
) -> Predictive:
    """The compensator of a body whose friction is observed, with a ``bandwidth`` [1/s] if used."""
    learning = learned_friction.design(friction, seen, p)
    return Predictive(
        learning=learning,
        alternation=vibration.design(
            ALTERNATING_REST * learning.highest, body.dt, SLOWEST_ALTERNATION
        ),
        prediction=design_prediction(body.a, body.b, body.drive, body.dt, HORIZON / bandwidth),
        drive=design_drive(body.drive, body.dt),
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
    seen: Observation,
) -> float:
    """F̂ [V] for the time when it acts; ``observed`` [V] is what the model lacks now.

    If that is NaN, the linear model does not hold, and F̂ is the modelled friction at the present
    speed. If the sample ``is_held``, the last F̂ is sent once more.
    """
    model, estimated = _due(memory, observation, x, observed, p, seen)
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
    seen: Observation,
) -> tuple[float, float]:
    """The modelled friction and all of it [V] when a command acts that is sent now."""
    fed_back = observation.fed_back
    acting_torque(memory.feedback, fed_back if not isnan(fed_back) else 0.0, p.drive)
    v, rest, learned = x[PHI_DOT], 0.0, memory.learned
    part = SMALLEST_PART
    if isnan(observed):
        learned_friction.forget(learned)
    else:
        part = max(allowed_share(memory.alternation, observed, p.alternation), part)
        share = observation.vibration.part
        learned_friction.learn(
            learned, v, observation.modelled_sent, observed, share, p.learning, seen
        )
        rest = observed
        if observation.applied.believed != applied.NONE:
            v = predicted(memory.feedback, x, PHI_DOT, p.prediction)
    viscous = p.learning.friction.viscous
    largest = LARGEST_ESTIMATE * part * p.learning.highest + viscous * abs(x[PHI_DOT])
    memory.bristle, dry = moved(learned, memory.bristle, v, p.learning)
    model = min(max(dry + viscous * v, -largest), largest)
    return model, min(max(model + rest, -largest), largest)


@inlined
def _ahead_of_lag(behind: float, due: float, p: Predictive) -> float:
    """What is sent so that ``behind`` the lag it follows what is due with a shorter one [V]."""
    return behind + p.inversion * (due - behind)


@inlined
def begin(memory: PredictiveMemory, x: np.ndarray, force: float, p: Predictive) -> None:
    """Begin in state ``x`` with a bristle under the ``force`` [V], and a torque held for long."""
    memory.bristle = learned_friction.begin(memory.learned, x[PHI_DOT], force, p.learning)
    memory.model_lag = memory.sent_lag = 0.0
    torque = x[APPLIED_TORQUE]
    assume_held(memory.feedback, 0.0 if isnan(torque) else torque)
