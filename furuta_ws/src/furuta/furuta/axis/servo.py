"""One sample of a servo: controller and friction compensation of an axis, from its position.

The compensators are those of the friction observer, whose constants suit the arm of the paper's
rig. So they are converted to units in which the axis resembles that arm: friction of 0.21 V
accelerates it by 9.5 rad/s², and the poles are at about 7 1/s. The controller takes the observer's
speed in place of a filtered derivative.
"""

from dataclasses import dataclass, field
from math import isnan, sqrt
from typing import NamedTuple

import numpy as np

from furuta.axis.axis import NO_RULE, Axis, Cascade, Controller, IntegralRule, poles
from furuta.limit_cycles.joint import Units
from furuta_friction.compensation import ObserverParameters
from furuta_friction.joint_observer import (
    JointDesign,
    JointMemory,
    JointModel,
    ObserverNodeParameters,
    design_joint,
    joint_friction,
)
from furuta_friction.learned_friction import LearningParameters
from furuta_model.compiled import inlined
from furuta_model.friction.lugre import highest_level
from furuta_model.friction.parameters import Friction
from furuta_model.late_drive import MAX_DELAY, LateDrive
from furuta_model.linear import KalmanParameters
from furuta_model.parameters import ParameterError, validated

# Of the paper's rig: level of friction [V], acceleration by it [rad/s²], size of the poles [1/s].
LEVEL, ACCELERATION, POLES = 0.21, 9.5, 7.0
# Bandwidth of the observed friction relative to that of the arm: no pendulum hangs from an axis, so
# its model also holds where it moves fast.
FASTER = 2.0
# Speed of the reference that counts as much as the own, on the paper's rig [rad/s].
REFERENCE_SPEED = 0.05
# Resolution [rad] that stands for a sensor without counts, on the paper's rig.
PERFECT = 3e-6


class Feedback(NamedTuple):
    """Torque per error, speed and speed of the reference, and its rate per error and speed."""

    error: float
    speed: float
    reference_speed: float
    integrates_error: float
    integrates_speed: float


class ServoDesign(NamedTuple):
    """Controller and compensation, in the units of the axis."""

    feedback: Feedback
    rule: IntegralRule
    observer: JointDesign
    dt: float


@dataclass
class ServoMemory:
    """Torque of the integral, last error and position, and the observer's memory."""

    integral: float = 0.0
    error: float = 0.0
    position: float = 0.0
    observer: JointMemory = field(default_factory=JointMemory)


def paper_units(axis: Axis, controller: Controller | None = None) -> Units:
    """Units in which the axis resembles the arm of the paper's rig; without a controller 1 s."""
    time = 1.0
    if controller is not None:
        sizes = np.abs(poles(axis, controller))
        sizes = sizes[sizes > 1e-9 * np.max(sizes, initial=0.0)]
        if not len(sizes):
            raise ParameterError("the loop has no poles but 0: give gains above 0")
        time = POLES / float(np.exp(np.mean(np.log(sizes))))
    level = highest_level(axis.friction)
    position = level / axis.inertia * time**2 / ACCELERATION
    return Units(time, position, level / LEVEL, np.eye(1))


def observer_parameters(
    axis: Axis,
    units: Units,
    compensation: str,
    resolution: float,
    sample_time: float,
    delay: float = 0.0,
) -> ObserverNodeParameters:
    """Parameters of the friction observer for an axis, with one of :data:`COMPENSATIONS`.

    The torque of the drive is known to act after a ``delay`` [s]. Raises :class:`ParameterError` if
    that is more samples than an observer remembers.

    Viscous friction is left to damp the motion. A bristle or a Stribeck velocity that the law does
    not have is that of the paper's arm.
    """
    late = round(delay / sample_time)
    if late > MAX_DELAY:
        raise ParameterError(
            f"delay must be at most {MAX_DELAY} samples, given {delay:g} s, which is {late}"
        )
    t, q, f = units.time, units.position, units.force
    usual, noise = ObserverParameters(), KalmanParameters().friction_process_noise
    bristle = axis.friction
    if axis.law not in ("lugre", "dahl"):
        bristle = Friction(
            sigma0=usual.friction.sigma0 * f / q, sigma1=usual.friction.sigma1 * f / q * t
        )
    dry = axis.friction._replace(viscous=0.0, sigma0=bristle.sigma0, sigma1=bristle.sigma1)
    if axis.law in ("coulomb", "stiction") or not dry.alpha1:
        dry = dry._replace(stribeck_velocity=usual.friction.stribeck_velocity * units.speed)
    learning, adaptive = usual.learning, usual.adaptive
    observer = ObserverParameters(
        compensation=compensation,
        friction=dry,
        observer_gain=0.0,
        adaptive=adaptive._replace(adaptation_gain=adaptive.adaptation_gain / t),
        bandwidth=FASTER * usual.bandwidth / t,
        learning=LearningParameters(*(rate / t for rate in learning)),
        drive=LateDrive(late),
        sample_time=sample_time,
    )
    return ObserverNodeParameters(
        observer,
        "axis",
        JointModel(
            inertia=axis.inertia,
            viscous=axis.friction.viscous,
            resolution=resolution or PERFECT * q,
            friction_process_noise=noise * f / sqrt(t),
            reference_speed=REFERENCE_SPEED * units.speed,
        ),
    )


def design_servo(
    controller: Controller, observer: ObserverNodeParameters, rule: IntegralRule = NO_RULE
) -> ServoDesign:
    """The controller, with the rule of its integral and the observer of these parameters."""
    dt = observer.observer.sample_time
    return ServoDesign(_feedback(controller), validated(rule), design_joint(observer), dt)


def _feedback(controller: Controller) -> Feedback:
    if isinstance(controller, Cascade):
        k, speed, integral = controller
        return Feedback(speed * k, -speed, 0.0, integral * k, -integral)
    kp, ki, kd, _ = controller
    return Feedback(kp, -kd, kd, ki, 0.0)


@inlined
def integral_torque(
    integral: float,
    change: float,
    error: float,
    last: float,
    moved: bool,
    load: float,
    rule: IntegralRule,
) -> float:
    """Torque of the integral [N m] after a sample behind a reference at rest.

    Args:
        integral: That before.
        change: What would be added without a rule.
        error: Measured error [rad].
        last: The last one that was not 0.
        moved: Whether the measured position has changed.
        load: Known torque that holds the axis.
        rule: The rule.
    """
    if rule.resets and error * last < 0.0:
        integral = load
    if abs(error) >= rule.dead_band:
        integral += change
    if moved and rule.limit > 0.0:
        integral = min(max(integral, load - rule.limit), load + rule.limit)
    return integral


@inlined
def servo_sample(
    memory: ServoMemory,
    position: float,
    torque: float,
    reference: float,
    reference_speed: float,
    p: ServoDesign,
) -> float:
    """The command [N m] until the next sample, with F̂ in it.

    Args:
        memory: What is remembered.
        position: Measured position [rad]; NaN if it is missing, but not in the first sample.
        torque: Torque that the drive has been given since the sample before [N m].
        reference: Position that is wanted [rad].
        reference_speed: Its speed [rad/s].
        p: The design.
    """
    friction = joint_friction(memory.observer, position, np.nan, torque, np.nan, p.observer)
    if isnan(position) and memory.observer.started:
        position = memory.observer.estimate[0]
    error, v, f = reference - position, memory.observer.estimate[1], p.feedback
    change = p.dt * (f.integrates_error * error + f.integrates_speed * v)
    if p.rule.dead_band > 0.0 or p.rule.resets or p.rule.limit > 0.0:
        if reference_speed != 0.0:
            memory.integral += change
        elif p.rule.resets and f.integrates_error == 0.0:
            memory.integral = memory.observer.load
        else:
            memory.integral = integral_torque(
                memory.integral,
                change,
                error,
                memory.error,
                position != memory.position,
                memory.observer.load,
                p.rule,
            )
        memory.position = position
        memory.error = error if error != 0.0 else memory.error
    else:
        memory.integral += change
    command = f.error * error + f.speed * v + f.reference_speed * reference_speed
    return command + memory.integral + friction
