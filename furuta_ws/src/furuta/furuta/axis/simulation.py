"""Simulates an axis with encoder, observer, compensator and controller.

The plant is simulated in units in which it resembles the arm of the paper's rig, controller and
compensation (:mod:`furuta.axis.servo`) in those of the axis.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from furuta.axis.axis import NO_RULE, Axis, Controller, IntegralRule, check_axis, released
from furuta.axis.servo import (
    ServoDesign,
    ServoMemory,
    design_servo,
    observer_parameters,
    paper_units,
    servo_sample,
)
from furuta.limit_cycles.joint import Units, friction_in
from furuta_friction.compensation import COMPENSATIONS
from furuta_model.block import new_memory, zeros
from furuta_model.compiled import compiled, inlined
from furuta_model.friction.laws import LAWS, FrictionLaw, friction_law
from furuta_model.friction.parameters import Friction
from furuta_model.integration import advance, substeps_for
from furuta_model.parameters import ParameterError
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI, PLANT_STATES
from furuta_recordings.recording import Recording

MOST_SAMPLES = 5_000_000


class LoopDesign(NamedTuple):
    """Plant and servo: ``dt``, ``position`` and ``force`` are in or of the units of the plant.

    ``resolution`` is a count of the encoder in those of the axis, 0 for a perfect sensor. A command
    acts ``delay`` samples late; with ``by_topic`` F̂ is that of the sample before.
    """

    body: FurutaPendulum
    law: FrictionLaw
    load_friction: float
    substeps: int
    dt: float
    position: float
    force: float
    resolution: float
    delay: int
    by_topic: bool
    servo: ServoDesign


@dataclass
class LoopMemory:
    """State of the plant, and memory of the servo."""

    x: np.ndarray = zeros(PLANT_STATES)
    servo: ServoMemory = field(default_factory=ServoMemory)


def design_loop(
    axis: Axis, units: Units, count: float, delay: float, by_topic: bool, servo: ServoDesign
) -> LoopDesign:
    """The loop of an axis in these units and a servo, whose torque acts after a ``delay`` [s]."""
    dt, friction = servo.dt / units.time, friction_in(units, axis.friction)
    inertia = axis.inertia * units.position / (units.force * units.time**2)
    body = FurutaPendulum(inertia, 1.0, 0.0, 0.0)
    return LoopDesign(
        body=body,
        law=friction_law(axis.law, friction),
        load_friction=axis.load_friction,
        substeps=substeps_for(dt, body, friction),
        dt=dt,
        position=units.position,
        force=units.force,
        resolution=count,
        delay=round(delay / servo.dt),
        by_topic=by_topic,
        servo=servo,
    )


@inlined
def under_load(law: FrictionLaw, load: float) -> FrictionLaw:
    """The law with a Coulomb level that is higher by the friction under a load."""
    f = law.parameters
    parameters = Friction(
        f.sigma0,
        f.sigma1,
        f.alpha0 + load,
        f.alpha1,
        f.stribeck_velocity,
        f.viscous,
        f.asymmetry,
    )
    return FrictionLaw(law.kind, parameters, law.level, law.breakaway, law.bristle, law.springs)


@inlined
def measured_position(position: float, p: LoopDesign) -> float:
    """A position [rad] as the encoder gives it."""
    if p.resolution > 0.0:
        position = p.resolution * np.floor(position / p.resolution + 0.5)
    return position


@compiled
def run_loop(
    memory: np.ndarray,
    reference: np.ndarray,
    speeds: np.ndarray,
    p: LoopDesign,
    series: np.ndarray,
) -> None:
    """Write true position, measured position and torque of each sample to ``series`` (3, n)."""
    x, commands = memory[0].x, np.zeros(len(reference))
    for k in range(len(reference)):
        position = p.position * x[PHI]
        measured = measured_position(position, p)
        friction = memory[0].servo.observer.friction
        sent = commands[k - 1] if k > 0 else 0.0
        commands[k] = servo_sample(
            memory[0].servo, measured, sent, reference[k], speeds[k], p.servo
        )
        if p.by_topic:
            commands[k] += friction - memory[0].servo.observer.friction
        torque = commands[k - p.delay] if k >= p.delay else 0.0
        series[0, k], series[1, k], series[2, k] = position, measured, torque
        force = torque / p.force
        law = under_load(p.law, p.load_friction * abs(force))
        advance(x, force, p.dt, p.substeps, p.body, law)


@dataclass(frozen=True, eq=False)
class AxisRecord:
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
        """What a user would have recorded, for :func:`furuta.identify`."""
        measured = np.full((len(self.time), 4), np.nan)
        measured[:, PHI] = self.measured
        return Recording("simulation", self.time, measured, self.time, self.torque)


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
    delay: float = 0.0,
    by_topic: bool = False,
    rule: IntegralRule = NO_RULE,
    start: float = 1.0,
    late: float = 0.0,
) -> AxisRecord:
    """Simulate an axis with encoder, controller and compensation; see :mod:`furuta.servo_axes`.

    ``start`` scales the error at the start. The torque is ``late`` [s] beside the ``delay``, which
    the observer knows.
    """
    choices = {"compensation": (compensation, COMPENSATIONS), "law": (axis.law, LAWS)}
    for name, (given, known) in choices.items():
        if given not in known:
            raise ParameterError(f"{name} must be one of {', '.join(known)}, given {given}")
    for each in (axis, model or axis):
        check_axis(each, controller)
    allowed = counts >= 0 and 1e-6 <= sample_time <= 0.1 and 0.0 <= delay <= 1.0
    if not (allowed and seconds > 0.0):
        raise ParameterError(
            "counts must be at least 0, sample_time 1e-6 to 0.1 s, delay 0 to 1 s and seconds "
            f"above 0, given {counts}, {sample_time:g}, {delay:g} and {seconds:g}"
        )
    if np.ndim(reference):
        positions, offset = np.array(reference, dtype=float), 0.0
    else:
        time = sample_time * np.arange(min(seconds / sample_time, MOST_SAMPLES + 1))
        positions = reference * time
        offset = 0.0 if reference else start * float(released(axis, controller, 2)[1])
    usable = positions.ndim == 1 and np.all(np.isfinite(positions))
    if not (usable and 1 < len(positions) <= MOST_SAMPLES):
        raise ParameterError(
            f"a simulation must have 2 to {MOST_SAMPLES} samples, all finite: choose other "
            "seconds, sample_time or reference"
        )
    speeds = np.gradient(positions, sample_time)
    units = paper_units(axis, controller)
    count = 2.0 * np.pi / counts if counts else 0.0
    observer = observer_parameters(model or axis, units, compensation, count, sample_time, delay)
    servo = design_servo(controller, observer, rule)
    design = design_loop(axis, units, count, delay + late, by_topic, servo)
    memory = new_memory(LoopMemory)
    memory[0]["x"][PHI] = (positions[0] - offset) / units.position
    series = np.empty((3, len(positions)))
    run_loop(memory, positions, speeds, design, series)
    if not np.all(np.isfinite(series)):
        raise ParameterError("the motion grows beyond all numbers: choose other gains or reference")
    position, measured, torque = series
    times: np.ndarray = sample_time * np.arange(len(positions))
    return AxisRecord(times, positions, position, measured, torque)
