r"""Observes the friction that acts now, from the arm's speed and the torque that acts on it.

.. math::
    s = \frac{1}{b}\Bigl(\dot φ - \int (A_{\dot φ}\,x + b(τ - m - r))\,dt\Bigr), \qquad
    r = -ks + w, \qquad \dot w = -0.7\,k^2 s

τ is the torque behind delay and lag of the drive, m a part of the friction that is modelled, and r
the rest, which is observed with the bandwidth k [1/s]. The loop of this observer does not lead
through the drive, so a late drive does not make it oscillate. s [V s] passes a low-pass filter with
the rate 3k: between motor and arm a belt turns the phase by half a turn, and without the filter the
compensation would drive its vibration. A vibration that is sustained nevertheless reduces k
(:mod:`furuta_friction.vibration`).
"""

from dataclasses import dataclass, field
from math import expm1, inf, isnan
from typing import Annotated, NamedTuple

import numpy as np

from furuta_friction import applied, vibration
from furuta_friction.applied import AppliedMemory, contained, too_late
from furuta_friction.vibration import Vibration, VibrationMemory, allowed_share
from furuta_model.compiled import inlined
from furuta_model.late_drive import (
    DriveMemory,
    LateDrive,
    SampledDrive,
    acting_torque,
    assume_held,
    design_drive,
)
from furuta_model.parameters import SELECTS
from furuta_model.state import APPLIED_TORQUE, PHI, PHI_DOT, THETA, THETA_DOT

# Gain of the integral relative to the square of the bandwidth; rate of the low-pass filter relative
# to the bandwidth; most of the bandwidth in a sample.
INTEGRAL, ROLL_OFF, LARGEST_STEP = 0.7, 3.0, 0.5
# Least bandwidth relative to the rate at which the body falls.
FASTER_THAN_FALL = 4.0
# Part of the bandwidth at the start of a compensation, so that it does not excite a vibration.
FIRST_PART = 0.25
# Vibration that is accepted, relative to the highest level of the friction model.
ACCEPTED_VIBRATION = 1.7
SMALLEST_VIBRATION = 1e-3  # [V]
# Pendulum angle within which the linear model holds [rad].
UPRIGHT = 0.7


class Body(NamedTuple):
    """What is known of the joint: A (4, 4) and b (4,) of ẋ = Ax + b(τ − F), drive, sample time.

    The model holds while the third state is at most ``valid_angle``.
    """

    a: np.ndarray
    b: np.ndarray
    drive: LateDrive
    dt: float
    valid_angle: float = UPRIGHT


class Observation(NamedTuple):
    """The sampled observer: row (4,) of A, b, 1/b of φ̇, bandwidth, limit of the integral [V]."""

    row: np.ndarray
    b: float
    inertia: float
    dt: float
    bandwidth: float
    share: float
    limit: float
    valid_angle: float
    first_part: float
    acts: Annotated[bool, SELECTS]
    drive: SampledDrive
    vibration: Vibration


@dataclass
class ObservationMemory:
    """What the observer remembers.

    Attributes:
        started: Whether it has started.
        speed: Speed of the arm if the friction were as observed [rad/s].
        drift: Its acceleration without the torque until the next sample [rad/s²].
        lost_momentum: s [V s].
        integral: w [V].
        rest: r [V].
        modelled_sent: Part of the friction that is modelled, as sent [V]; 0 without one.
        fed_back: The applied torque without F̂, if that acts [V].
        drive: What the drive has been given, without the modelled part of the friction.
        applied: Memory of what F̂ does in the torque.
        vibration: Memory of the detector.
    """

    started: bool = False
    speed: float = 0.0
    drift: float = 0.0
    lost_momentum: float = 0.0
    integral: float = 0.0
    rest: float = 0.0
    modelled_sent: float = 0.0
    fed_back: float = 0.0
    drive: DriveMemory = field(default_factory=DriveMemory)
    applied: AppliedMemory = field(default_factory=AppliedMemory)
    vibration: VibrationMemory = field(default_factory=VibrationMemory)


def limited(bandwidth: float, dt: float) -> float:
    """The bandwidth [1/s] that samples of ``dt`` [s] allow."""
    return min(bandwidth, LARGEST_STEP / dt)


def least_bandwidth(body: Body) -> float:
    """The bandwidth [1/s] below which the body falls within the times that are predicted."""
    if body.valid_angle == inf:
        return 0.0
    return FASTER_THAN_FALL * float(np.max(np.linalg.eigvals(body.a).real))


def design(body: Body, bandwidth: float, limit: float, level: float, acts: bool) -> Observation:
    """The observer of a body, whose integral has a ``limit`` [V].

    If what it observes ``acts`` on the body, a vibration beyond what suits the ``level`` of
    friction [V] reduces it.
    """
    accepted = max(ACCEPTED_VIBRATION * level, SMALLEST_VIBRATION) if acts else inf
    return Observation(
        row=body.a[PHI_DOT].copy(),
        b=float(body.b[PHI_DOT]),
        inertia=1.0 / float(body.b[PHI_DOT]) if body.b[PHI_DOT] else 0.0,
        dt=body.dt,
        bandwidth=bandwidth,
        share=-expm1(-ROLL_OFF * bandwidth * body.dt),
        limit=limit,
        valid_angle=body.valid_angle,
        first_part=FIRST_PART if acts else 1.0,
        acts=acts,
        drive=design_drive(body.drive, body.dt),
        vibration=vibration.design(accepted, body.dt),
    )


@inlined
def observe(memory: ObservationMemory, x: np.ndarray, p: Observation) -> float:
    """The rest r [V] of the friction in state ``x`` (5,), where the torque is that applied.

    Far from upright, or if a number is unknown, the rest is NaN and the observer starts anew.
    """
    v, voltage = x[PHI_DOT], x[APPLIED_TORQUE]
    if p.acts:
        memory.fed_back = voltage - contained(memory.applied)
        voltage += too_late(memory.applied) - memory.modelled_sent
    known = abs(x[THETA]) <= p.valid_angle and not isnan(voltage + x[THETA_DOT])
    torque = acting_torque(memory.drive, voltage if known else 0.0, p.drive)
    if not known:
        memory.started = False
        return np.nan
    if memory.started:
        memory.speed += p.dt * (memory.drift + p.b * torque)
    else:
        memory.started, memory.speed = True, v
        memory.lost_momentum = memory.integral = memory.rest = 0.0
        memory.vibration.part = p.first_part
    memory.lost_momentum += p.share * (p.inertia * (v - memory.speed) - memory.lost_momentum)
    gained = p.bandwidth * memory.lost_momentum
    part = allowed_share(memory.vibration, gained, p.vibration)
    w = memory.integral - INTEGRAL * p.dt * p.bandwidth * gained * part * part
    memory.integral = min(max(w, -p.limit), p.limit)
    memory.rest = memory.integral - part * gained
    memory.drift = _free_acceleration(x, p) - p.b * memory.rest
    return memory.rest


@inlined
def _free_acceleration(x: np.ndarray, p: Observation) -> float:
    """Acceleration [rad/s²] of the arm without torque and friction."""
    row = p.row
    return row[0] * x[PHI] + row[1] * x[PHI_DOT] + row[2] * x[THETA] + row[3] * x[THETA_DOT]


@inlined
def balancing_friction(x: np.ndarray, p: Observation) -> float:
    """The friction [V] with which the arm is not accelerated; 0 if the torque is not known."""
    friction = x[APPLIED_TORQUE] + p.inertia * _free_acceleration(x, p)
    return friction if not isnan(friction) else 0.0


@dataclass
class ResponseMemory:
    """A known friction as it would be observed: the integral of what is not [V s], s and w."""

    unobserved: float = 0.0
    lost_momentum: float = 0.0
    integral: float = 0.0


@inlined
def respond(memory: ResponseMemory, known: float, part: float, p: Observation) -> float:
    """What would be observed now [V] of a friction that has been ``known`` [V] for a sample.

    It is observed with a ``part`` of the bandwidth.
    """
    k = part * p.bandwidth
    observed = memory.integral + k * memory.lost_momentum
    memory.unobserved += p.dt * (known - observed)
    memory.lost_momentum += p.share * (memory.unobserved - memory.lost_momentum)
    memory.integral += INTEGRAL * p.dt * k * k * memory.lost_momentum
    return memory.integral + k * memory.lost_momentum


@inlined
def forget_response(memory: ResponseMemory) -> None:
    """Begin anew, with a friction that was 0 V."""
    memory.unobserved = memory.lost_momentum = memory.integral = 0.0


@inlined
def begin(memory: ObservationMemory, x: np.ndarray) -> None:
    """Begin in state ``x``, as if the drive had been given its torque for long."""
    memory.started, memory.modelled_sent = False, 0.0
    torque = x[APPLIED_TORQUE]
    assume_held(memory.drive, 0.0 if isnan(torque) else torque)
    applied.begin(memory.applied, torque)
