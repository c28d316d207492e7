"""The stages of a sample as loops over the lanes of a block.

A stage is made from the functions that a single run calls, so an outcome is the same to the last
bit. What is rare would spoil the loops: an estimate that starts or has to replace a reading, a
controller that catches or drops the pendulum. Such a lane calls the function of a single run in
that sample. The others compute only what nearly every sample needs, with the same bits.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from furuta.lanes.lane_compiler import widest_vectors
from furuta.oscillation import accumulate_midpoint
from furuta.outcomes import Sums, measure_sample, note_fall
from furuta_control import estimation, readings
from furuta_control.control import ControllerDesign, ControllerMemory, control, limited
from furuta_control.estimation import (
    UNFILTERED,
    EstimatorDesign,
    EstimatorMemory,
    estimate_state,
)
from furuta_control.modes import balance
from furuta_friction.compensation import (
    CompensationDesign,
    CompensationMemory,
    continued_estimate,
    continues,
    estimate_friction,
)
from furuta_model.block import zeros
from furuta_model.compiled import compiled, inlined
from furuta_model.elementary import sin_cos
from furuta_model.friction.laws import FrictionLaw, friction_force
from furuta_model.integration import MAX_SUBSTEPS, advance_half, advance_whole, sufficient_substeps
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Actuator, Sensors, drive, measure
from furuta_model.state import APPLIED_TORQUE, BRISTLE, PHI_DOT, PLANT_STATES, SIGNALS, THETA
from furuta_sim.plant import NOISE_CHANNELS


@dataclass
class LaneMemory:
    """What a lane remembers, and the signals between its stages.

    Attributes:
        x: Plant state (5,).
        noise, measurement, estimate: As in a single run.
        estimator, observer, controller: As in a single run.
        friction_estimate, command, torque: F̂, u and the torque applied [V].
        substeps: Integration steps of this sample; ``step``: their length [s].
        sine, cosine: Of θ at the start of the step.
        v_mid, w_mid: Speeds of arm and pendulum in the middle of the step [rad/s].
        sums: What is measured.
    """

    x: np.ndarray = zeros(PLANT_STATES)
    noise: np.ndarray = zeros(NOISE_CHANNELS)
    measurement: np.ndarray = zeros(SIGNALS)
    estimate: np.ndarray = zeros(SIGNALS)
    estimator: EstimatorMemory = field(default_factory=EstimatorMemory)
    observer: CompensationMemory = field(default_factory=CompensationMemory)
    controller: ControllerMemory = field(default_factory=ControllerMemory)
    friction_estimate: float = 0.0
    command: float = 0.0
    torque: float = 0.0
    substeps: int = 0
    step: float = 0.0
    sine: float = 0.0
    cosine: float = 0.0
    v_mid: float = 0.0
    w_mid: float = 0.0
    sums: Sums = field(default_factory=Sums)


class LanePlant(NamedTuple):
    """What the plant of a lane computes with: a rig without faults and parts."""

    model: FurutaPendulum
    friction: FrictionLaw
    actuator: Actuator
    sample_time: float
    substeps: int


class LaneDesign(NamedTuple):
    """A closed loop, as a lane computes it."""

    plant: LanePlant
    sensors: Sensors
    estimator_design: EstimatorDesign
    compensation: CompensationDesign
    controller_design: ControllerDesign


@inlined
def estimate_continues(
    memory: EstimatorMemory, measurement: np.ndarray, p: EstimatorDesign
) -> bool:
    """Whether the estimate goes on with this method and every reading is usable."""
    running = p.method + 1 if p.filtered else UNFILTERED
    usable = readings.all_usable(memory.readings, measurement, p.readings)
    return (memory.running == running) & estimation.is_bounded(memory) & usable


@inlined
def continue_estimate(
    memory: EstimatorMemory, measurement: np.ndarray, p: EstimatorDesign, estimate: np.ndarray
) -> None:
    """:func:`furuta_control.estimation.estimate_state` for an estimate that continues."""
    readings.forget_unusable(memory.readings)
    if p.filtered:
        estimation.update(memory, measurement, p)
    else:
        estimation.take_measurement(memory, measurement)
    estimation.finish(memory, measurement, p, estimate)


@inlined
def balancing_continues(memory: ControllerMemory, x: np.ndarray, p: ControllerDesign) -> bool:
    """Whether the pendulum was balanced and still is; the mode is ``balance``."""
    return memory.balance.balancing & balance.is_allowed(x, p.balance)


@inlined
def continue_balancing(
    memory: ControllerMemory, x: np.ndarray, friction: float, p: ControllerDesign
) -> float:
    """:func:`furuta_control.control.control` for balancing that continues."""
    friction = balance.scaled(memory.balance, friction, p.balance)
    return limited(balance.command(memory.balance, x, friction, p.balance), p)


def _in_each_lane(step: Callable[[Any], None]) -> Callable[[Any, int], None]:
    """Make a loop that calls an inlined function for every lane."""

    def run(lanes: Any, count: int) -> None:
        widest_vectors()
        for i in range(count):
            step(lanes[i])

    return compiled(run, cached=False)


@compiled
def read_lanes(lanes: Any, count: int) -> None:
    """Read the sensors."""
    widest_vectors()
    for i in range(count):
        lane = lanes[i]
        measure(lane.x, lane.noise, lane.sensors, lane.measurement)
        lane.measurement[APPLIED_TORQUE] = lane.torque


@_in_each_lane
@inlined
def _estimate_singly(lane: Any) -> None:
    """Estimate the state as a single run does."""
    estimate_state(lane.estimator, lane.measurement, lane.estimator_design, lane.estimate)


@compiled
def estimate_lanes(lanes: Any, count: int) -> None:
    """Estimate the state."""
    widest_vectors()
    unusual = 0
    for i in range(count):
        lane = lanes[i]
        p, measurement = lane.estimator_design, lane.measurement
        usual = estimate_continues(lane.estimator, measurement, p)
        unusual += 0 if usual else 1
    if unusual > 0:
        _estimate_singly(lanes, count)
        return
    for i in range(count):
        lane = lanes[i]
        p, measurement = lane.estimator_design, lane.measurement
        continue_estimate(lane.estimator, measurement, p, lane.estimate)


@_in_each_lane
@inlined
def _observe_singly(lane: Any) -> None:
    """Estimate the friction as a single run does."""
    lane.friction_estimate = estimate_friction(lane.observer, lane.estimate, lane.compensation)


@compiled
def observe_lanes(lanes: Any, count: int) -> None:
    """Estimate the friction."""
    widest_vectors()
    unusual = 0
    for i in range(count):
        lane = lanes[i]
        usual = continues(lane.observer, lane.estimate, lane.compensation)
        unusual += 0 if usual else 1
    if unusual > 0:
        _observe_singly(lanes, count)
        return
    for i in range(count):
        lane = lanes[i]
        p = lane.compensation
        lane.friction_estimate = continued_estimate(lane.observer, lane.estimate, p)


@_in_each_lane
@inlined
def _control_singly(lane: Any) -> None:
    """Compute the command as a single run does."""
    p, friction = lane.controller_design, lane.friction_estimate
    lane.command = control(lane.controller, lane.estimate, friction, p)


@compiled
def control_lanes(lanes: Any, count: int) -> None:
    """Compute the command."""
    widest_vectors()
    unusual = 0
    for i in range(count):
        lane = lanes[i]
        p = lane.controller_design
        usual = balancing_continues(lane.controller, lane.estimate, p)
        unusual += 0 if usual else 1
    if unusual > 0:
        _control_singly(lanes, count)
        return
    for i in range(count):
        lane = lanes[i]
        p, friction = lane.controller_design, lane.friction_estimate
        lane.command = continue_balancing(lane.controller, lane.estimate, friction, p)


@compiled
def midpoint_lanes(lanes: Any, count: int) -> None:
    """Include the sample in the midpoint of the motion."""
    widest_vectors()
    for i in range(count):
        accumulate_midpoint(lanes[i].sums.oscillation, lanes[i].x)


@compiled
def measure_lanes(lanes: Any, count: int) -> None:
    """Include the sample in what is measured."""
    widest_vectors()
    for i in range(count):
        lane = lanes[i]
        friction = friction_force(lane.x[PHI_DOT], lane.x[BRISTLE], lane.plant.friction)
        measure_sample(
            lane.sums,
            lane.x,
            lane.command,
            friction,
            lane.friction_estimate,
            lane.plant.sample_time,
        )


@inlined
def _finish(lane: Any) -> None:
    """Finish a substep."""
    p, u, h = lane.plant, lane.torque, lane.step
    sine, cosine, v_mid, w_mid = lane.sine, lane.cosine, lane.v_mid, lane.w_mid
    advance_whole(lane.x, u, h, sine, cosine, v_mid, w_mid, p.model, p.friction)


_finish_all = _in_each_lane(_finish)


@compiled
def move_lanes(lanes: Any, count: int) -> None:
    """Move the rigs over a sample."""
    widest_vectors()
    most, least = 1, MAX_SUBSTEPS
    for i in range(count):
        lane = lanes[i]
        note_fall(lane.sums, lane.x)
        lane.torque = drive(lane.command, lane.plant.actuator)
        lane.substeps = sufficient_substeps(lane.x, lane.plant.sample_time, lane.plant.substeps)
        most, least = max(most, lane.substeps), min(least, lane.substeps)
    # Several short loops are faster than a long one: the processor works on several vectors of a
    # short one at a time, because it looks only some hundred instructions ahead.
    for substep in range(most):
        for i in range(count):
            lane = lanes[i]
            lane.sine, lane.cosine = sin_cos(lane.x[THETA])
            lane.step = lane.plant.sample_time / lane.substeps
        for i in range(count):
            lane = lanes[i]
            p, u, h = lane.plant, lane.torque, lane.step
            lane.v_mid, lane.w_mid = advance_half(
                lane.x, u, h, lane.sine, lane.cosine, p.model, p.friction
            )
        if substep < least:
            _finish_all(lanes, count)
        else:
            _finish_some(lanes, count, substep)


@compiled
def _finish_some(lanes: Any, count: int, substep: int) -> None:
    widest_vectors()
    for i in range(count):
        if substep < lanes[i].substeps:
            _finish(lanes[i])


class Stage(NamedTuple):
    """A loop over the lanes, and the fields that it uses; others do not affect its code."""

    function: Callable[..., None]
    fields: tuple[str, ...]


_READ = Stage(read_lanes, ("sensors", "x", "noise", "measurement", "torque"))
_ESTIMATE = Stage(estimate_lanes, ("estimator_design", "measurement", "estimate", "estimator"))
_OBSERVE = Stage(observe_lanes, ("compensation", "estimate", "observer", "friction_estimate"))
_CONTROL = Stage(
    control_lanes,
    ("controller_design", "estimate", "controller", "friction_estimate", "command"),
)
_MIDPOINT = Stage(midpoint_lanes, ("x", "sums"))
_MEASURE = Stage(measure_lanes, ("plant", "x", "friction_estimate", "command", "sums"))
_SUBSTEP = ("substeps", "step", "sine", "cosine", "v_mid", "w_mid")
_MOVE = Stage(move_lanes, ("plant", "x", "command", "torque", *_SUBSTEP, "sums"))
# The stages of a sample in the three parts of a run: transient, midpoint of the motion, measured.
PARTS = (
    (_READ, _ESTIMATE, _OBSERVE, _CONTROL, _MOVE),
    (_READ, _ESTIMATE, _OBSERVE, _CONTROL, _MIDPOINT, _MOVE),
    (_READ, _ESTIMATE, _OBSERVE, _CONTROL, _MEASURE, _MOVE),
)
STAGES = tuple(dict.fromkeys(stage for part in PARTS for stage in part))
