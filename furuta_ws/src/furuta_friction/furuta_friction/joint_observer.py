r"""Friction of a joint from its position and torque, in the joint's own units.

.. math::
    J\dot v = τ - g(q) - σ_2 v - F, \qquad \dot F = w, \qquad
    g(q) = f_0 + g_s\sin q + g_c\cos q

A stationary Kalman filter for this model gives the speed to the compensator, with τ − g as the
applied torque. If the speed of the reference is known, the compensator gets a mixture: a measured
speed is late, that of the reference is not, but says nothing while the reference rests.
"""

from dataclasses import dataclass, field
from math import inf, isnan, nan, sqrt
from typing import Annotated, Final, NamedTuple

import numpy as np

from furuta_friction.compensation import (
    CompensationDesign,
    CompensationMemory,
    ObserverParameters,
    compensate,
    design_for_body,
    is_ready,
    observe_friction,
)
from furuta_friction.compensation import pass_missing as pass_missing_compensation
from furuta_friction.compensation import reset as reset_compensation
from furuta_friction.disturbance_observer import Body
from furuta_model.block import zeros
from furuta_model.compiled import compiled, inlined
from furuta_model.elementary import sin_cos
from furuta_model.late_drive import (
    DriveMemory,
    SampledDrive,
    acting_torque,
    assume_held,
    design_drive,
)
from furuta_model.parameters import INLINE, SELECTS, About, ParameterError, designed_once
from furuta_model.sensors import variance
from furuta_model.state import (
    APPLIED_TORQUE,
    PHI,
    PHI_DOT,
    RIGID_STATES,
    SIGNALS,
    THETA,
    is_possible,
)

ARM: Final = "arm"
# Index of the load in the state of a joint, where the pendulum's angle is in that of the arm.
LOAD: Final = THETA
# Largest level [V] and viscous friction [V s/rad] of it.
LARGEST_OF_ARM: Final = 100.0

# Position, speed, effort, and speed of the reference.
JointSample = tuple[float, float, float, float]
NO_SAMPLE: JointSample = (0.0, 0.0, 0.0, 0.0)


class JointModel(NamedTuple):
    """Parameters of a joint other than the pendulum's arm [rad, N m or m, N]."""

    inertia: Annotated[
        float,
        About(
            "inertia J; 0: not known, then the measured speed is used and no friction is observed",
            "kg m²",
            0.0,
            1e6,
        ),
    ] = 0.0
    viscous: Annotated[
        float,
        About("viscous friction that damps the motion and is not compensated", "N m s/rad", 0, 1e6),
    ] = 0.0
    offset: Annotated[float, About("constant load f₀", "N m", -1e6, 1e6)] = 0.0
    gravity_sin: Annotated[float, About("load g_s sin q", "N m", -1e6, 1e6)] = 0.0
    gravity_cos: Annotated[float, About("load g_c cos q", "N m", -1e6, 1e6)] = 0.0
    resolution: Annotated[
        float, About("smallest change of the measured position", "rad", 1e-12, 1.0)
    ] = 1e-4
    friction_process_noise: Annotated[
        float, About("random change of the friction in one second", "N m/√s", 1e-9, 1e9)
    ] = 1.0
    reference_speed: Annotated[
        float,
        About("speed at which the reference's speed counts as much as the own", "rad/s", 0.0, 1e3),
    ] = 0.05


class ObserverNodeParameters(NamedTuple):
    """Parameters of the node ``friction_observer``."""

    observer: Annotated[ObserverParameters, INLINE] = ObserverParameters()
    joint: Annotated[
        str,
        About(
            "arm: the pendulum's, from the estimator; any other joint: from position and effort in "
            "joint_states, with the model axis",
            read_only=True,
        ),
    ] = ARM
    axis: JointModel = JointModel()

    def check(self) -> None:
        """Reject a joint that the filter cannot be designed for, and levels that no arm has."""
        if self.joint != ARM:
            design_joint(self)
            return
        for name in ("alpha0", "alpha1", "viscous"):
            if (value := getattr(self.observer.friction, name)) > LARGEST_OF_ARM:
                raise ParameterError(
                    f"{name} of the arm must be at most {LARGEST_OF_ARM:g}, given {value:g}"
                )


class JointDesign(NamedTuple):
    """The observer of a joint: ``step`` (3, 4) of (q, v, F) and torque, ``gain`` (3,) for q."""

    observes: Annotated[bool, SELECTS]
    step: np.ndarray
    gain: np.ndarray
    model: JointModel
    drive: SampledDrive
    compensation: CompensationDesign


@dataclass
class JointMemory:
    """Estimate (q, v, F), load and acting torque since the sample before, F̂, memories of parts."""

    started: bool = False
    estimate: np.ndarray = zeros(3)
    state: np.ndarray = zeros(SIGNALS)
    load: float = 0.0
    torque: float = 0.0
    friction: float = 0.0
    drive: DriveMemory = field(default_factory=DriveMemory)
    compensation: CompensationMemory = field(default_factory=CompensationMemory)


@designed_once
def design_joint(p: ObserverNodeParameters) -> JointDesign:
    """The observer that the parameters describe.

    Raises:
        ParameterError: The filter cannot be designed for these numbers.
    """
    model, dt = p.axis, p.observer.sample_time
    known = model.inertia > 0.0
    step, gain = _kalman(model, dt) if known else (np.zeros((3, 4)), np.zeros(3))
    a, b = np.zeros((RIGID_STATES, RIGID_STATES)), np.zeros(RIGID_STATES)
    a[PHI, PHI_DOT] = 1.0
    if known:
        a[PHI_DOT, PHI_DOT], b[PHI_DOT] = -model.viscous / model.inertia, 1.0 / model.inertia
    a[PHI_DOT, LOAD] = -b[PHI_DOT]
    body = Body(a, b, p.observer.drive, dt, inf)
    return JointDesign(
        observes=known,
        step=step,
        gain=gain,
        model=model,
        drive=design_drive(p.observer.drive, dt),
        compensation=design_for_body(p.observer, body),
    )


def _kalman(model: JointModel, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """Transition and gain, designed in units of the resolution, the sample time and the inertia."""
    from scipy.linalg import expm, solve_discrete_are  # slow; the arm does not need it

    force = model.inertia / dt**2
    units = model.resolution * np.array([1.0, 1.0 / dt, force, force])
    system, measured = np.zeros((4, 4)), variance(0.0, 1.0)
    system[0, 1] = 1.0
    system[1, 1:] = -model.viscous * dt / model.inertia, -1.0, 1.0
    with np.errstate(all="ignore"):
        try:
            step = expm(system)[:3]
            # A friction that is drawn anew every sample acts over the whole sample.
            column = step[:, 2] * model.friction_process_noise * sqrt(dt) / units[2]
            noise = np.outer(column, column)
            covariance = solve_discrete_are(step[:, :3].T, np.eye(1, 3).T, noise, [[measured]])
        except (np.linalg.LinAlgError, ValueError):
            raise ParameterError(
                f"no filter for inertia {model.inertia:g}, resolution {model.resolution:g} and "
                f"friction_process_noise {model.friction_process_noise:g} of axis at sample_time "
                f"{dt:g}"
            ) from None
    gain = covariance[:, 0] / (covariance[0, 0] + measured)
    return step * units[:3, None] / units, gain * units[:3] / units[0]


@inlined
def reset(memory: JointMemory) -> None:
    """Begin anew with the next sample; levels that have adapted are kept."""
    memory.started = False
    memory.friction = 0.0
    assume_held(memory.drive, 0.0)
    reset_compensation(memory.compensation)


@inlined
def joint_friction(
    memory: JointMemory,
    position: float,
    speed: float,
    torque: float,
    reference_speed: float,
    p: JointDesign,
) -> float:
    """F̂ [N m] from a sample of a joint; each one that is missing is passed by :func:`pass_missing`.

    Args:
        memory: What is remembered.
        position: Measured position [rad]; NaN if it is missing.
        speed: Measured speed [rad/s], used only without an inertia.
        torque: Torque that was applied since the sample before [N m]; NaN if not known.
        reference_speed: Speed of the reference [rad/s]; NaN without one.
        p: The design.
    """
    x, compensation = memory.state, memory.compensation
    x[PHI_DOT], x[APPLIED_TORQUE] = speed, nan
    if p.observes:
        _move(memory, torque, p)
        _correct(memory, position, p)
        x[LOAD], x[PHI_DOT] = memory.load, memory.estimate[1]
    else:
        memory.started = False
    memory.friction = 0.0
    if is_ready(compensation, x, p.compensation):
        observed, own = observe_friction(compensation, x, p.compensation), x[PHI_DOT]
        if not isnan(reference_speed) and reference_speed != 0.0:
            square, half = reference_speed * reference_speed, p.model.reference_speed
            x[PHI_DOT] += square / (square + half * half) * (reference_speed - own)
        memory.friction = compensate(compensation, x, observed, p.compensation)
    return memory.friction


@inlined
def pass_missing(memory: JointMemory, torque: float, p: JointDesign) -> None:
    """Move the observer by one sample that is missing, under a ``torque`` [N m]; F̂ is held."""
    if p.observes:
        _move(memory, torque, p)
        memory.state[PHI_DOT] = memory.estimate[1]
        pass_missing_compensation(memory.compensation, memory.state, p.compensation)


@compiled
def joint_step(memory: np.ndarray, x: JointSample, design: np.ndarray, samples: int) -> float:
    """F̂ from a sample, ``samples`` after the last one, anew if that is 0; for callers in Python.

    Memory and design are blocks. NaN, without a step, if a number is impossible.
    """
    if not is_possible(np.array(x)):
        return np.nan
    if samples == 0:
        reset(memory[0])
    position, speed, effort, reference_speed = x
    for _ in range(samples - 1):
        pass_missing(memory[0], effort, design[0])
    return joint_friction(memory[0], position, speed, effort, reference_speed, design[0])


@inlined
def _move(memory: JointMemory, torque: float, p: JointDesign) -> None:
    """Move the estimate by a sample under the ``torque`` [N m]; NaN if that is not known."""
    memory.state[APPLIED_TORQUE] = torque
    if not isnan(torque):
        memory.torque = acting_torque(memory.drive, torque, p.drive)
    if not memory.started:
        return
    q, v, friction = memory.estimate[0], memory.estimate[1], memory.estimate[2]
    torque = memory.torque - memory.load
    for i in range(3):
        memory.estimate[i] = (
            p.step[i, 0] * q + p.step[i, 1] * v + p.step[i, 2] * friction + p.step[i, 3] * torque
        )


@inlined
def _correct(memory: JointMemory, position: float, p: JointDesign) -> None:
    """Correct the estimate by a measured position, if there is one."""
    if isnan(position):
        return
    starts = not memory.started
    if not starts:
        innovation = position - memory.estimate[0]
        for i in range(3):
            memory.estimate[i] += p.gain[i] * innovation
    else:
        memory.started = True
        memory.estimate[0], memory.estimate[1], memory.estimate[2] = position, 0.0, 0.0
    sine, cosine = sin_cos(position)
    memory.load = p.model.offset + p.model.gravity_sin * sine + p.model.gravity_cos * cosine
    if starts:
        # The drive has held the joint, so a torque that is late does not seem to be missing.
        memory.torque = memory.load
        assume_held(memory.drive, memory.load)
