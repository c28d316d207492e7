r"""Simulates an axis with encoder, observer, compensator and controller.

The compensators are those of the friction observer of the pendulum, as they are. So the axis is
simulated in units in which it resembles the arm of the paper's rig: friction of 0.21 V accelerates
it by 9.5 rad/s², and the poles are at about 7 1/s. An encoder measures the position. A stationary
Kalman filter finds speed and friction from it,

.. math:: J\dot v = τ - σ_2 v - F, \qquad \dot F = w

and the controller takes this speed in place of a filtered derivative.
"""

from dataclasses import dataclass, field
from math import inf
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm, solve_discrete_are

from furuta.axis.axis import Axis, Cascade, Controller, check_axis, poles, released
from furuta.limit_cycles.joint import Units, friction_in
from furuta_control.estimators.kalman import KalmanParameters
from furuta_control.modes import super_twisting
from furuta_control.modes.super_twisting import SuperTwisting, SuperTwistingMemory
from furuta_friction.compensation import (
    COMPENSATIONS,
    CompensationDesign,
    CompensationMemory,
    ObserverParameters,
    design_compensator,
    estimate_friction,
)
from furuta_model.block import new_memory, zeros
from furuta_model.compiled import compiled
from furuta_model.friction.laws import LAWS, FrictionLaw, friction_law
from furuta_model.friction.lugre import highest_level
from furuta_model.friction.parameters import Friction
from furuta_model.integration import advance, substeps_for
from furuta_model.parameters import ParameterError
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import variance
from furuta_model.state import OBSERVED_FRICTION, PHI, PHI_DOT, PLANT_STATES, SIGNALS
from furuta_recordings.recording import Recording

# Of the paper's rig: level of friction [V], acceleration by it [rad/s²], size of the poles [1/s].
LEVEL, ACCELERATION, POLES = 0.21, 9.5, 7.0
# Bound on the rate of the friction for super-twisting [V/s], and largest correction [V].
RATE_BOUND, LARGEST_CORRECTION = 10.0, 1.0
SUPER_TWISTING = "super_twisting"
CANDIDATES = (*COMPENSATIONS, SUPER_TWISTING)
# Variance of a position [rad²] that is measured without an encoder's counts.
SMALLEST_VARIANCE = 1e-12
MOST_SAMPLES = 5_000_000


class Feedback(NamedTuple):
    """Gains on error, speed, speed of the reference and integral; what the integral integrates."""

    error: float
    speed: float
    reference_speed: float
    integral: float
    integrates_error: float
    integrates_speed: float


class Observer(NamedTuple):
    """Transition (3, 4) of (q, v, F) and torque over one sample, and gain (3,) for the position."""

    step: np.ndarray
    gain: np.ndarray


class LoopDesign(NamedTuple):
    """The loop in the units of the simulation.

    ``resolution`` is a count of the encoder, 0 for a perfect sensor.
    """

    body: FurutaPendulum
    law: FrictionLaw
    substeps: int
    resolution: float
    dt: float
    feedback: Feedback
    observer: Observer
    compensation: CompensationDesign
    twisting: SuperTwisting


@dataclass
class LoopMemory:
    """Plant and estimate, integral of the controller, and memories of the compensators."""

    x: np.ndarray = zeros(PLANT_STATES)
    estimate: np.ndarray = zeros(3)
    integral: float = 0.0
    compensation: CompensationMemory = field(default_factory=CompensationMemory)
    twisting: SuperTwistingMemory = field(default_factory=SuperTwistingMemory)


def paper_units(axis: Axis, controller: Controller) -> Units:
    """Units in which the axis resembles the arm of the paper's rig."""
    sizes = np.abs(poles(axis, controller))
    sizes = sizes[sizes > 1e-9 * np.max(sizes, initial=0.0)]
    if not len(sizes):
        raise ParameterError("the loop has no poles but 0: give gains above 0")
    time = POLES / float(np.exp(np.mean(np.log(sizes))))
    level = highest_level(axis.friction)
    position = level / axis.inertia * time**2 / ACCELERATION
    return Units(time, position, level / LEVEL, np.eye(1))


def design_loop(
    axis: Axis,
    model: Axis,
    controller: Controller,
    compensation: str,
    count: float,
    sample_time: float,
    units: Units,
) -> LoopDesign:
    """The loop in these units. Observer and compensation have the friction of the ``model``."""
    dt = sample_time / units.time
    true, assumed = friction_in(units, axis.friction), friction_in(units, model.friction)
    of_inertia = units.position / (units.force * units.time**2)
    body = FurutaPendulum(axis.inertia * of_inertia, 1.0, 0.0, 0.0)
    inertia = model.inertia * of_inertia
    # The bristle of a law that has none is that of the paper's arm.
    bristle = assumed if model.law in ("lugre", "dahl") else Friction()
    dry = assumed._replace(viscous=0.0, sigma0=bristle.sigma0, sigma1=bristle.sigma1)
    twists = compensation == SUPER_TWISTING
    parameters = ObserverParameters(
        compensation="none" if twists else compensation, friction=dry, sample_time=dt
    )
    return LoopDesign(
        body=body,
        law=friction_law(axis.law, true),
        substeps=substeps_for(dt, body, true),
        resolution=count / units.position,
        dt=dt,
        feedback=_feedback(controller, units),
        observer=_observer(inertia, assumed.viscous, count / units.position, dt),
        compensation=design_compensator(parameters),
        twisting=super_twisting.design(
            rate_bound=RATE_BOUND if twists else 0.0,
            bandwidth=0.0,
            vibration_limit=inf,
            closed=(1.0 / inertia, -assumed.viscous / inertia, 0.0, 0.0),
            b=1.0 / inertia,
            dt=dt,
        ),
    )


def _feedback(controller: Controller, units: Units) -> Feedback:
    """The controller in these units."""
    stiffness, damping = units.position / units.force, units.speed / units.force
    if isinstance(controller, Cascade):
        k, speed = controller.position * units.time, controller.speed * damping
        integral = controller.integral * stiffness
        return Feedback(speed * k, -speed, 0.0, integral, k, -1.0)
    kp, ki, kd = controller.kp * stiffness, controller.ki * stiffness, controller.kd * damping
    return Feedback(kp, -kd, kd, ki * units.time, 1.0, 0.0)


def _observer(inertia: float, viscous: float, count: float, dt: float) -> Observer:
    """The stationary Kalman filter for the position, with the process noise of the rig's."""
    system = np.zeros((4, 4))
    system[0, 1] = 1.0
    system[1, 1:] = np.array([-viscous, -1.0, 1.0]) / inertia
    step = expm(system * dt)[:3]
    noise = KalmanParameters().friction_process_noise
    # A friction that is drawn anew every sample acts on speed and position over the whole sample.
    column = step[:, 2].copy()
    process = dt * noise**2 * np.outer(column, column)
    measured = max(variance(0.0, count), SMALLEST_VARIANCE)
    output = np.eye(1, 3)
    covariance = solve_discrete_are(step[:, :3].T, output.T, process, [[measured]])
    return Observer(step, covariance[:, 0] / (covariance[0, 0] + measured))


@compiled
def run_loop(
    memory: np.ndarray,
    reference: np.ndarray,
    speeds: np.ndarray,
    p: LoopDesign,
    series: np.ndarray,
) -> None:
    """Write true position, measured position and torque of each sample to ``series`` (3, n)."""
    loop, state, torque = memory[0], np.zeros(SIGNALS), 0.0
    x, estimate, before = loop.x, loop.estimate, np.zeros(3)
    for k in range(len(reference)):
        measured = x[PHI]
        if p.resolution > 0.0:
            measured = p.resolution * np.floor(measured / p.resolution + 0.5)
        if k > 0:
            before[:] = estimate
            for i in range(3):
                estimate[i] = p.observer.step[i, 3] * torque
                for j in range(3):
                    estimate[i] += p.observer.step[i, j] * before[j]
            innovation = measured - estimate[0]
            for i in range(3):
                estimate[i] += p.observer.gain[i] * innovation
        error, v = reference[k] - measured, estimate[1]
        state[PHI], state[PHI_DOT], state[OBSERVED_FRICTION] = -error, v, estimate[2]
        f = p.feedback
        loop.integral += p.dt * (f.integrates_error * error + f.integrates_speed * v)
        torque = f.error * error + f.speed * v + f.reference_speed * speeds[k]
        torque += f.integral * loop.integral
        nominal = torque
        torque += estimate_friction(loop.compensation, state, p.compensation)
        if p.twisting.rate_bound > 0.0:
            torque += super_twisting.correction(
                loop.twisting, state, nominal, LARGEST_CORRECTION, p.twisting
            )
        series[0, k], series[1, k], series[2, k] = x[PHI], measured, torque
        advance(x, torque, p.dt, p.substeps, p.body, p.law)


class AxisRecord(NamedTuple):
    """Series (n,) of an axis: time [s], reference, true and measured position [rad], torque [N m].

    A torque is that from its sample until the next one.
    """

    time: np.ndarray
    reference: np.ndarray
    position: np.ndarray
    measured: np.ndarray
    torque: np.ndarray

    @property
    def error(self) -> np.ndarray:
        """Reference minus true position (n,) [rad]."""
        return self.reference - self.position

    @property
    def recording(self) -> Recording:
        """What a user would have recorded, for :func:`furuta.identify_axis`."""
        measured = np.full((len(self.time), 4), np.nan)
        measured[:, PHI] = self.measured
        return Recording("simulation", self.time, measured, self.time, self.torque)

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """The recording as columns, for :func:`furuta.write_series`."""
        return {"time": self.time, "position": self.measured, "torque": self.torque}


def simulate_axis(
    axis: Axis,
    controller: Controller,
    *,
    seconds: float = 20.0,
    reference: float | np.ndarray = 0.0,
    compensation: str = "none",
    model: Axis | None = None,
    counts: int = 4096,
    sample_time: float = 1e-3,
) -> AxisRecord:
    """Simulate an axis with encoder, controller and friction compensation.

    Args:
        axis: The true axis.
        controller: Its gains; the filter of a PID is replaced by the observer's speed.
        seconds: Length of the simulation [s].
        reference: Its constant speed [rad/s], or its positions (n,) [rad] at all samples. With
            positions the axis starts at the first of them, otherwise as :func:`servo_cycle` has
            it: at rest away from a reference at rest, on one that moves.
        compensation: One of the compensators, or super_twisting.
        model: The axis as observer and compensator assume it; the true one by default.
        counts: Counts of the encoder per turn; 0 for a perfect sensor.
        sample_time: Time between samples [s].

    Raises:
        ParameterError: An argument is not allowed, or the loop has no poles.
    """
    choices = {"compensation": (compensation, CANDIDATES), "law": (axis.law, LAWS)}
    for name, (given, known) in choices.items():
        if given not in known:
            raise ParameterError(f"{name} must be one of {', '.join(known)}, given {given}")
    for each in (axis, model or axis):
        check_axis(each, controller)
    if not (counts >= 0 and 1e-6 <= sample_time <= 0.1 and seconds > 0.0):
        raise ParameterError(
            "counts must be at least 0, sample_time 1e-6 to 0.1 s and seconds above 0, given "
            f"{counts}, {sample_time:g} and {seconds:g}"
        )
    if np.ndim(reference):
        positions, offset = np.array(reference, dtype=float), 0.0
    else:
        time = sample_time * np.arange(min(seconds / sample_time, MOST_SAMPLES + 1))
        positions = reference * time
        offset = 0.0 if reference else float(released(axis, controller, 2)[1])
    usable = positions.ndim == 1 and np.all(np.isfinite(positions))
    if not (usable and 1 < len(positions) <= MOST_SAMPLES):
        raise ParameterError(
            f"a simulation must have 2 to {MOST_SAMPLES} samples, all finite: choose other "
            "seconds, sample_time or reference"
        )
    speeds = np.gradient(positions, sample_time)
    units = paper_units(axis, controller)
    count = 2.0 * np.pi / counts if counts else 0.0
    design = design_loop(axis, model or axis, controller, compensation, count, sample_time, units)
    memory = new_memory(LoopMemory)
    memory[0]["x"][PHI] = memory[0]["estimate"][0] = (positions[0] - offset) / units.position
    series = np.empty((3, len(positions)))
    run_loop(memory, positions / units.position, speeds / units.speed, design, series)
    if not np.all(np.isfinite(series)):
        raise ParameterError("the motion grows beyond all numbers: choose other gains or reference")
    position, measured, torque = series * [[units.position], [units.position], [units.force]]
    times: np.ndarray = sample_time * np.arange(len(positions))
    return AxisRecord(times, positions, position, measured, torque)
