"""The stages of a sample as loops over the lanes of a block.

A stage is made from the functions that a single run calls, so an outcome is the same to the last
bit. What is rare would spoil the loops: an estimate that starts or has to replace a reading, a
controller that catches or drops the pendulum. Such a lane calls the function of a single run in
that sample.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from furuta_control import control as controller
from furuta_control import estimation as estimator
from furuta_control.control import ControllerDesign
from furuta_control.estimation import EstimatorDesign
from furuta_friction.compensation import Compensator, estimate_without_switch
from furuta_model.compiled import compiled, inlined
from furuta_model.elementary import sin_cos
from furuta_model.friction.laws import FrictionLaw, friction_force
from furuta_model.integration import MAX_SUBSTEPS, advance_half, advance_whole, sufficient_substeps
from furuta_model.parts.converter import Actuator, drive
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors
from furuta_model.state import APPLIED_TORQUE, BRISTLE, PHI_DOT, THETA
from furuta_sim.lanes.lane_compiler import widest_vectors
from furuta_sim.plant import measure
from furuta_sim.simulation.closed_loop import measure_sample, note_fall
from furuta_sim.simulation.oscillation import accumulate_midpoint

# Indices of the signals between the stages.
(
    FRICTION_ESTIMATE,
    COMMAND,
    TORQUE,
    SUBSTEPS,
    STEP,
    SINE,
    COSINE,
    V_MID,
    W_MID,
    LANE_SIGNALS,
) = range(10)


class LanePlant(NamedTuple):
    """What the plant of a lane computes with: a rig without faults and parts."""

    model: FurutaPendulum
    friction: FrictionLaw
    actuator: Actuator
    sample_time: float
    substeps: int


class Lane(NamedTuple):
    """A closed loop in a lane."""

    plant: LanePlant
    sensors: Sensors
    estimator_design: EstimatorDesign
    compensator: Compensator
    controller_design: ControllerDesign
    x: np.ndarray
    noise: np.ndarray
    measurement: np.ndarray
    estimate: np.ndarray
    estimator: np.ndarray
    observer: np.ndarray
    controller: np.ndarray
    signals: np.ndarray
    accumulator: np.ndarray
    sums: np.ndarray


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
        lane.measurement[APPLIED_TORQUE] = lane.signals[TORQUE]


@_in_each_lane
@inlined
def _estimate_singly(lane: Any) -> None:
    """Estimate the state as a single run does."""
    p = lane.estimator_design
    estimator.estimate_state(lane.estimator, lane.measurement, p, lane.estimate)


@compiled
def estimate_lanes(lanes: Any, count: int) -> None:
    """Estimate the state."""
    widest_vectors()
    unusual = 0
    for i in range(count):
        lane = lanes[i]
        usual = estimator.continues(lane.estimator, lane.measurement, lane.estimator_design)
        unusual += 0 if usual else 1
    if unusual > 0:
        _estimate_singly(lanes, count)
        return
    for i in range(count):
        lane = lanes[i]
        p = lane.estimator_design
        estimator.continue_estimate(lane.estimator, lane.measurement, p, lane.estimate)


@compiled
def observe_lanes(lanes: Any, count: int) -> None:
    """Estimate the friction."""
    widest_vectors()
    for i in range(count):
        lane = lanes[i]
        lane.signals[FRICTION_ESTIMATE] = estimate_without_switch(
            lane.observer, lane.estimate, lane.compensator
        )


@_in_each_lane
@inlined
def _control_singly(lane: Any) -> None:
    """Compute the command as a single run does."""
    p, friction = lane.controller_design, lane.signals[FRICTION_ESTIMATE]
    lane.signals[COMMAND] = controller.control(lane.controller, lane.estimate, friction, p)


@compiled
def control_lanes(lanes: Any, count: int) -> None:
    """Compute the command."""
    widest_vectors()
    unusual = 0
    for i in range(count):
        lane = lanes[i]
        usual = controller.continues(lane.controller, lane.estimate, lane.controller_design)
        unusual += 0 if usual else 1
    if unusual > 0:
        _control_singly(lanes, count)
        return
    for i in range(count):
        lane = lanes[i]
        p, friction = lane.controller_design, lane.signals[FRICTION_ESTIMATE]
        lane.signals[COMMAND] = controller.continue_control(
            lane.controller, lane.estimate, friction, p
        )


@compiled
def midpoint_lanes(lanes: Any, count: int) -> None:
    """Include the sample in the midpoint of the motion."""
    widest_vectors()
    for i in range(count):
        accumulate_midpoint(lanes[i].accumulator, lanes[i].x)


@compiled
def measure_lanes(lanes: Any, count: int) -> None:
    """Include the sample in what is measured."""
    widest_vectors()
    for i in range(count):
        lane = lanes[i]
        friction = friction_force(lane.x[PHI_DOT], lane.x[BRISTLE], lane.plant.friction)
        estimated = lane.signals[FRICTION_ESTIMATE]
        measure_sample(
            lane.accumulator, lane.sums, lane.x, lane.signals[COMMAND], friction, estimated
        )


@inlined
def _finish(lane: Any) -> None:
    """Finish a substep."""
    signals, p = lane.signals, lane.plant
    u, h, sine, cosine = signals[TORQUE], signals[STEP], signals[SINE], signals[COSINE]
    v_mid, w_mid = signals[V_MID], signals[W_MID]
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
        lane.signals[TORQUE] = drive(lane.signals[COMMAND], lane.plant.actuator)
        substeps = sufficient_substeps(lane.x, lane.plant.sample_time, lane.plant.substeps)
        lane.signals[SUBSTEPS] = float(substeps)
        most, least = max(most, substeps), min(least, substeps)
    # Several short loops are faster than a long one: the processor works on several vectors of a
    # short one at a time, because it looks only some hundred instructions ahead.
    for substep in range(most):
        for i in range(count):
            signals = lanes[i].signals
            signals[SINE], signals[COSINE] = sin_cos(lanes[i].x[THETA])
            signals[STEP] = lanes[i].plant.sample_time / signals[SUBSTEPS]
        for i in range(count):
            lane = lanes[i]
            signals, p = lane.signals, lane.plant
            u, h, sine, cosine = signals[TORQUE], signals[STEP], signals[SINE], signals[COSINE]
            signals[V_MID], signals[W_MID] = advance_half(
                lane.x, u, h, sine, cosine, p.model, p.friction
            )
        if substep < least:
            _finish_all(lanes, count)
        else:
            _finish_some(lanes, count, substep)


@compiled
def _finish_some(lanes: Any, count: int, substep: int) -> None:
    widest_vectors()
    for i in range(count):
        if substep < lanes[i].signals[SUBSTEPS]:
            _finish(lanes[i])


class Stage(NamedTuple):
    """A loop over the lanes, and the fields that it uses; others do not affect its code."""

    function: Callable[..., None]
    fields: tuple[str, ...]


_READ = Stage(read_lanes, ("sensors", "x", "noise", "measurement", "signals"))
_ESTIMATE = Stage(
    estimate_lanes, ("estimator_design", "measurement", "estimate", "estimator", "signals")
)
_OBSERVE = Stage(observe_lanes, ("compensator", "estimate", "observer", "signals"))
_CONTROL = Stage(control_lanes, ("controller_design", "estimate", "controller", "signals"))
_MIDPOINT = Stage(midpoint_lanes, ("x", "accumulator"))
_MEASURE = Stage(measure_lanes, ("plant", "x", "signals", "accumulator", "sums"))
_MOVE = Stage(move_lanes, ("plant", "x", "signals", "sums"))
# The stages of a sample in the three parts of a run: transient, midpoint of the motion, measured.
PARTS = (
    (_READ, _ESTIMATE, _OBSERVE, _CONTROL, _MOVE),
    (_READ, _ESTIMATE, _OBSERVE, _CONTROL, _MIDPOINT, _MOVE),
    (_READ, _ESTIMATE, _OBSERVE, _CONTROL, _MEASURE, _MOVE),
)
MOST_STAGES = 6
