"""Simulates many closed loops side by side in the lanes of the processor's vector instructions.

Every stage of a sample is a loop over the lanes of a block, made from the functions that a single
run calls: sensors, estimator, friction observer, controller, measurement and plant. An outcome is
the same to the last bit as that of a single run.

What is rare would spoil the loops: an estimate that starts or has to replace a reading, a
controller that catches or drops the pendulum. Such a lane calls the function of a single run in
that sample. Rigs with faults of the sensors, with parts (cogging, pushes, a drive's dynamics and
others) or springs, and controllers with another mode or an excitation run singly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from furuta_analysis.simulation.closed_loop import (
    SETTLED,
    SUMS,
    Loop,
    Outcome,
    measure_sample,
    note_fall,
    summary,
)
from furuta_analysis.simulation.oscillation import ACCUMULATOR_SIZE, accumulate_midpoint
from furuta_control import control as controller
from furuta_control import estimation as estimator
from furuta_control.control import ControllerDesign, design_controller
from furuta_control.estimation import EstimatorDesign, design_estimator
from furuta_friction import compensation
from furuta_friction.compensation import Compensator, design_compensator, estimate_friction
from furuta_model.compiled import compiled
from furuta_model.friction.laws import FrictionLaw, friction_force
from furuta_model.integration import advance_substep, sufficient_substeps
from furuta_model.lanes import Lanes, LanesType, layout_of
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors
from furuta_model.state import APPLIED_TORQUE, BRISTLE, PHI_DOT, PLANT_STATES, SIGNALS
from furuta_sim.parameters import Actuator
from furuta_sim.plant import NOISE_CHANNELS, design_plant, drive, measure

# Lanes of a block. A multiple of every vector's width, and few enough that a block stays in the
# processor's first cache.
WIDTH = 32
# Samples for which noise is drawn ahead.
NOISE_SAMPLES = 256
# Numbers that select what is computed, besides truth values.
SELECTORS = frozenset({"kind", "method", "mode"})
# Numbers whose zero means that a part is off.
OFF_AT_ZERO = frozenset(
    {"bits", "encoder_counts", "tachometer_bits", "potentiometer_bits", "patience"}
    | {"integral_share", "rate_bound"}
)
# Indices of the signals between the stages.
FRICTION_ESTIMATE, COMMAND, TORQUE, SUBSTEPS, USUAL = range(5)


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


def suits_lanes(loop: Loop) -> bool:
    """Whether the loop can run in a lane."""
    plant = design_plant(loop.plant)
    control = loop.controller
    usual = control.enabled and control.mode == "balance" and control.excitation.kind == "none"
    return usual and not plant.parts.any and not plant.faults.any


def lane_of(loop: Loop) -> Lane:
    """The loop in its initial state."""
    plant = design_plant(loop.plant)
    x = np.zeros(PLANT_STATES)
    x[:BRISTLE] = loop.plant.initial
    return Lane(
        LanePlant(plant.model, plant.friction, plant.actuator, plant.sample_time, plant.substeps),
        plant.sensors,
        design_estimator(loop.estimator),
        design_compensator(loop.observer),
        design_controller(loop.controller),
        x,
        *(np.zeros(size) for size in _SIZES),
    )


_SIZES = (
    NOISE_CHANNELS,
    SIGNALS,
    SIGNALS,
    estimator.MEMORY,
    compensation.MEMORY,
    controller.MEMORY,
    USUAL + 1,
    ACCUMULATOR_SIZE,
    SUMS,
)


def is_constant(name: str, value: Any) -> bool:
    """Whether a number selects what is computed, so that it is a constant of the block."""
    return isinstance(value, bool) or name in SELECTORS or (name in OFF_AT_ZERO and value == 0)


@compiled
def read_lanes(lanes: LanesType, count: int) -> None:
    """Read the sensors."""
    for i in range(count):
        lane = lanes[i]
        measure(lane.x, lane.noise, lane.sensors, lane.measurement)
        lane.measurement[APPLIED_TORQUE] = lane.signals[TORQUE]


@compiled
def estimate_lanes(lanes: LanesType, count: int) -> None:
    """Estimate the state."""
    unusual = 0
    for i in range(count):
        lane = lanes[i]
        p = lane.estimator_design
        usual = estimator.continues(lane.estimator, lane.measurement, p)
        lane.signals[USUAL] = 1.0 if usual else 0.0
        unusual += 0 if usual else 1
        if usual:
            estimator.continue_estimate(lane.estimator, lane.measurement, p, lane.estimate)
    if unusual == 0:
        return
    for i in range(count):
        lane = lanes[i]
        if lane.signals[USUAL] == 0.0:
            p = lane.estimator_design
            estimator.estimate_state(lane.estimator, lane.measurement, p, lane.estimate)


@compiled
def observe_lanes(lanes: LanesType, count: int) -> None:
    """Estimate the friction."""
    for i in range(count):
        lane = lanes[i]
        friction = estimate_friction(lane.observer, lane.estimate, lane.compensator)
        lane.signals[FRICTION_ESTIMATE] = friction


@compiled
def control_lanes(lanes: LanesType, count: int) -> None:
    """Compute the command."""
    unusual = 0
    for i in range(count):
        lane = lanes[i]
        p = lane.controller_design
        usual = controller.continues(lane.controller, lane.estimate, p)
        lane.signals[USUAL] = 1.0 if usual else 0.0
        unusual += 0 if usual else 1
        if usual:
            lane.signals[COMMAND] = controller.continue_control(
                lane.controller, lane.estimate, lane.signals[FRICTION_ESTIMATE], p
            )
    if unusual == 0:
        return
    for i in range(count):
        lane = lanes[i]
        if lane.signals[USUAL] == 0.0:
            p = lane.controller_design
            friction = lane.signals[FRICTION_ESTIMATE]
            lane.signals[COMMAND] = controller.control(lane.controller, lane.estimate, friction, p)


@compiled
def midpoint_lanes(lanes: LanesType, count: int) -> None:
    """Include the sample in the midpoint of the motion."""
    for i in range(count):
        accumulate_midpoint(lanes[i].accumulator, lanes[i].x)


@compiled
def measure_lanes(lanes: LanesType, count: int) -> None:
    """Include the sample in what is measured."""
    for i in range(count):
        lane = lanes[i]
        friction = friction_force(lane.x[PHI_DOT], lane.x[BRISTLE], lane.plant.friction)
        estimated = lane.signals[FRICTION_ESTIMATE]
        measure_sample(
            lane.accumulator, lane.sums, lane.x, lane.signals[COMMAND], friction, estimated
        )


@compiled
def move_lanes(lanes: LanesType, count: int) -> None:
    """Move the rigs over a sample."""
    most = 1
    for i in range(count):
        lane = lanes[i]
        note_fall(lane.sums, lane.x)
        lane.signals[TORQUE] = drive(lane.signals[COMMAND], lane.plant.actuator)
        substeps = sufficient_substeps(lane.x, lane.plant.sample_time, lane.plant.substeps)
        lane.signals[SUBSTEPS] = float(substeps)
        most = max(most, substeps)
    for substep in range(most):
        for i in range(count):
            lane = lanes[i]
            substeps = lane.signals[SUBSTEPS]
            if substep < substeps:
                p = lane.plant
                h = p.sample_time / substeps
                advance_substep(lane.x, lane.signals[TORQUE], h, p.model, p.friction)


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
_PARTS = (
    (_READ, _ESTIMATE, _OBSERVE, _CONTROL, _MOVE),
    (_READ, _ESTIMATE, _OBSERVE, _CONTROL, _MIDPOINT, _MOVE),
    (_READ, _ESTIMATE, _OBSERVE, _CONTROL, _MEASURE, _MOVE),
)
_MOST_STAGES = 6


class Group(NamedTuple):
    """What loops have in common that run in one block: layout, rows, and samples of a run."""

    layout: Any
    rows: int
    samples: int


def group_of(lane: Lane, samples: int) -> Group:
    """The group of a loop."""
    return Group(*layout_of(lane, is_constant), samples)


def run_block(group: Group, loops: Sequence[Loop], lanes: Sequence[Lane], settled: float) -> Any:
    """Outcomes of up to :data:`WIDTH` loops of a group; lanes to spare repeat the first loop."""
    block = Lanes(group.layout, group.rows, WIDTH)
    for i in range(WIDTH):
        block.fill(i, lanes[i if i < len(lanes) else 0])
    measured = max(1, round(settled * group.samples))
    _run_samples(block, loops, group.samples, group.samples - measured)
    accumulators, sums = block.rows("accumulator"), block.rows("sums")
    return [
        summary(accumulators[:, i], sums[:, i], loop.plant.sample_time, group.samples, measured)
        for i, loop in enumerate(loops)
    ]


def _run_samples(block: Lanes, loops: Sequence[Loop], samples: int, transient: int) -> None:
    """Run all samples; the noise of each lane is that of its loop's own seed."""
    stages = np.array([_addresses(part, block) for part in _PARTS])
    generators = [np.random.default_rng(each.plant.seed) for each in loops]
    noise = np.zeros((WIDTH, NOISE_SAMPLES, NOISE_CHANNELS))
    for first in range(0, samples, NOISE_SAMPLES):
        if not loops[0].plant.sensors.ideal:
            for i, generator in enumerate(generators):
                generator.standard_normal(out=noise[i])
        last = min(first + NOISE_SAMPLES, samples)
        _run_stages(stages, block.address, block.rows("noise"), noise, first, last, transient)


def _addresses(part: tuple[Stage, ...], block: Lanes) -> list[int]:
    """Addresses of the machine code of the stages, 0 for none."""
    found = [_address(each.function, block.type(each.fields)) for each in part]
    return found + [0] * (_MOST_STAGES - len(found))


@lru_cache(maxsize=1024)
def _address(function: Any, block_type: LanesType) -> int:
    arguments = (block_type, types.intp)
    function.compile(arguments)
    result = function.overloads[arguments]
    return int(result.library.get_pointer_to_function(result.fndesc.llvm_func_name))


@intrinsic
def _call_stage(_: Any, address: Any, block: Any, count: Any) -> Any:
    """Call a stage by its address; so the loop over the samples is compiled once for all stages."""

    def generate(context: Any, builder: Any, sig: Any, arguments: Any) -> Any:
        pointer, integer = ir.IntType(8).as_pointer(), ir.IntType(64)
        result, error = builder.alloca(pointer), builder.alloca(pointer)
        kind = ir.FunctionType(
            ir.IntType(32), [result.type, error.type, ir.DoubleType().as_pointer(), integer]
        )
        stage = builder.inttoptr(arguments[0], kind.as_pointer())
        memory = builder.inttoptr(arguments[1], ir.DoubleType().as_pointer())
        builder.call(stage, [result, error, memory, arguments[2]])
        return context.get_dummy_value()

    return types.none(types.intp, types.intp, types.intp), generate


@compiled
def _run_stages(
    stages: np.ndarray,
    block: int,
    noise_rows: np.ndarray,
    noise: np.ndarray,
    first: int,
    last: int,
    transient: int,
) -> None:
    """Run the samples from ``first`` to before ``last``; ``noise`` (lanes, samples, channels)."""
    channels, width = noise_rows.shape
    for k in range(first, last):
        for i in range(width):
            for channel in range(channels):
                noise_rows[channel, i] = noise[i, k - first, channel]
        part = 0 if k < transient // 2 else 1 if k < transient else 2
        for stage in stages[part]:
            if stage != 0:
                _call_stage(stage, block, width)
