"""Simulates many closed loops side by side in the lanes of the processor's vector instructions.

Loops that compute alike form a group: the same kinds of law, compensation, estimator and sensors,
and as many samples. Up to 64 loops of a group run in one block
(:mod:`furuta.lanes.lane_stages`); each has parameters, seed and initial state of its
own.

Rigs with faults of the sensors, with parts (cogging, pushes, a drive's dynamics and others) or
springs, controllers with another mode or an excitation, and own compensators and estimators run
singly. So do loops whose stages are not compiled yet, until their runs would have taken longer than
the compilation.
"""

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.core import cgutils

from furuta.lanes.lane_compiler import (
    Lanes,
    LanesType,
    Layout,
    field_of,
    joined,
    layout_of,
    numbers_of,
)
from furuta.lanes.lane_stages import (
    PARTS,
    STAGES,
    LaneDesign,
    LaneMemory,
    LanePlant,
    Stage,
)
from furuta.outcomes import Outcome, measured_samples, summary
from furuta_control.control import design_controller
from furuta_control.estimation import METHOD_NAMES, EstimatorParameters, design_estimator
from furuta_friction.compensation import (
    COMPENSATIONS,
    design_compensator,
)
from furuta_model.compiled import compiled, make_intrinsic
from furuta_model.friction.laws import PAPER, FrictionLaw
from furuta_model.parameters import OFF_AT_ZERO, SELECTS
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Actuator, Sensors
from furuta_model.state import BRISTLE, PLANT_STATES
from furuta_sim.parameters import PlantParameters
from furuta_sim.plant import NOISE_CHANNELS, design_plant
from furuta_sim.simulation.closed_loop import Loop

# Most lanes of a block: many, because starting a loop over them costs time, but what a sample uses
# of the block has to stay in the processor's first cache. That is some 70 numbers per lane with
# ideal sensors and without a filter, and some 200 otherwise.
WIDTH = 32
WIDTH_WITHOUT_FILTER = 64
# Lanes of the widest vectors; a block runs a multiple of them.
VECTOR = 8
# Samples below which a single run takes no longer than preparing the loop for a lane.
FEWEST_SAMPLES = 500
# Distance of two rows. With a divisor of 4096 bytes a load would often seem to depend on a store
# before it, because the processor compares only the lowest bits of addresses.
BETWEEN_ROWS = 8
# Samples for which noise is drawn ahead.
NOISE_SAMPLES = 256


def is_constant(marked: tuple[Any, ...], value: Any) -> bool:
    """Whether a number selects what is computed, so that it is a constant of the block."""
    off = OFF_AT_ZERO in marked and value == 0
    return isinstance(value, bool) or SELECTS in marked or off


class Group(NamedTuple):
    """What the loops of a block have in common: layouts of the designs, samples, most lanes."""

    layouts: tuple[int, ...]
    samples: int
    width: int

    @property
    def stride(self) -> int:
        """Distance of two rows of a block."""
        return self.width + BETWEEN_ROWS


class PreparedLoop(NamedTuple):
    """A loop for a lane: its group and the numbers of its :class:`Lane` before the memories.

    Loops with the same designs share their numbers, so a waiting loop needs little memory.
    """

    group: Group
    numbers: tuple[np.ndarray, ...]
    plant: PlantParameters


def prepare(loop: Loop, seconds: float) -> PreparedLoop | None:
    """The loop for a lane, or None if it has to run singly."""
    control = loop.controller
    if not control.enabled or control.mode != "balance" or control.excitation.kind != "none":
        return None
    if loop.observer.compensation not in COMPENSATIONS or loop.estimator.method not in METHOD_NAMES:
        return None
    samples = max(1, round(seconds / loop.plant.sample_time))
    if samples < FEWEST_SAMPLES:
        return None
    plant = design_plant(loop.plant)
    if plant.parts.is_active or plant.parts.faults.is_active:
        return None
    moved = LanePlant(
        model=plant.model,
        friction=plant.friction,
        actuator=plant.actuator,
        sample_time=plant.sample_time,
        substeps=plant.substeps,
    )
    estimation = _needed_estimator(loop)
    parts = (
        (
            _plant_layout(plant.friction._replace(parameters=PAPER), plant.actuator),
            numbers_of(moved),
        ),
        _part(Sensors._make, loop.plant.sensors),
        _part(design_estimator, estimation),
        _part(design_compensator, loop.observer),
        _part(design_controller, control),
    )
    x = np.zeros(PLANT_STATES)
    x[:BRISTLE] = loop.plant.initial
    return PreparedLoop(
        group=Group(
            layouts=tuple(layout for layout, _ in parts),
            samples=samples,
            width=_width(loop.plant.sensors, estimation),
        ),
        numbers=(*(numbers for _, numbers in parts), x),
        plant=loop.plant,
    )


def _width(sensors: Sensors, estimation: EstimatorParameters) -> int:
    plain = sensors.ideal and estimation.method == "lowpass"
    return WIDTH_WITHOUT_FILTER if plain else WIDTH


def _needed_estimator(loop: Loop) -> EstimatorParameters:
    """The estimator, without a filter if the sensors are ideal, which does not filter."""
    if not loop.estimator.sensors.ideal:
        return loop.estimator
    return loop.estimator._replace(method="lowpass")


# The layouts of designs, numbered, so that groups compare fast.
_LAYOUTS: dict[Layout, int] = {}


@lru_cache(maxsize=4096)
def _part(design: Callable[[Any], Any], parameters: Any) -> tuple[int, np.ndarray]:
    """The number of a design's layout, and its numbers."""
    designed = design(parameters)
    return _layout_number(designed), numbers_of(designed)


def _layout_number(design: Any) -> int:
    layout, _ = layout_of(design, is_constant)
    return _LAYOUTS.setdefault(layout, len(_LAYOUTS))


@lru_cache(maxsize=256)
def _plant_layout(law: FrictionLaw, actuator: Actuator) -> int:
    """The layout does not depend on the real numbers, which differ between the loops of a study."""
    return _layout_number(LanePlant(FurutaPendulum(), law, actuator, 0.0, 1))


@lru_cache(maxsize=256)
def _layout(group: Group) -> tuple[Layout, int]:
    """Layout and rows of a group's blocks: the fields of the design, then those of the memory."""
    layouts = list(_LAYOUTS)
    (_, memory), _ = layout_of(LaneMemory(), lambda marked, value: False)
    names = (*LaneDesign._fields, *(name for name, _, _ in memory))
    parts = (*(layouts[number] for number in group.layouts), *(part for _, _, part in memory))
    return joined(names, parts)


def run_block(loops: Sequence[PreparedLoop], settled: float) -> list[Outcome]:
    """Outcomes of at most ``width`` loops of one group; lanes to spare repeat the first loop."""
    group, block = loops[0].group, block_of(loops)
    samples, measured = group.samples, measured_samples(group.samples, settled)
    _run_samples(block, loops, samples - measured)
    outcomes = []
    for i, loop in enumerate(loops):
        outcomes.append(summary(block.values("sums", i), loop.plant, samples, measured))
    return outcomes


def block_of(loops: Sequence[PreparedLoop]) -> Lanes:
    """A block with the loops at their start."""
    group = loops[0].group
    layout, rows = _layout(group)
    block = Lanes(layout, rows, group.stride)
    for i in range(_used(loops)):
        numbers = np.concatenate(loops[i if i < len(loops) else 0].numbers)
        # The block begins with zeros. A controller that only balances has thousands of them.
        given = np.flatnonzero(numbers.view(np.int64))
        block.data[given, i] = numbers[given]
    return block


def _used(loops: Sequence[PreparedLoop]) -> int:
    """Lanes that the loops take."""
    return -(-len(loops) // VECTOR) * VECTOR


def _run_samples(block: Lanes, loops: Sequence[PreparedLoop], transient: int) -> None:
    """Run all samples; the noise of each lane is that of its loop's own seed."""
    group = loops[0].group
    stages = np.zeros((len(PARTS), len(STAGES)), dtype=np.int64)
    for part, addresses in zip(PARTS, stages, strict=True):
        addresses[: len(part)] = [stage_address(stage, group) for stage in part]
    _, sensors = field_of(block.layout, "sensors")
    _, (_, _, ideal) = field_of(sensors, "ideal")
    generators = [] if ideal else [np.random.default_rng(loop.plant.seed) for loop in loops]
    noise = np.zeros((_used(loops), NOISE_SAMPLES, 0 if ideal else NOISE_CHANNELS))
    rows = block.rows("noise")[:, : len(noise)]
    for first in range(0, group.samples, NOISE_SAMPLES):
        for i, generator in enumerate(generators):
            generator.standard_normal(out=noise[i])
        last = min(first + NOISE_SAMPLES, group.samples)
        run_stages(stages, block.address, rows, noise, first, last, transient)


def compile_stages(loops: Iterable[Loop]) -> None:
    """Compile the stages of the groups of ``loops``; later batches find them on the disk."""
    for loop in loops:
        prepared = prepare(loop, 1.0)
        if prepared is not None:
            for stage in STAGES:
                stage_address(stage, prepared.group)


def is_compiled(group: Group) -> bool:
    """Whether the machine code of the group's stages exists, in memory or on the disk."""
    return all(_exists(stage, group) for stage in STAGES)


@lru_cache(maxsize=1024)
def stage_address(stage: Stage, group: Group) -> int:
    """Address of the machine code of a stage, which is compiled if need be."""
    arguments = _argument_types(stage, group)
    function: Any = stage.function
    function.compile(arguments)
    result = function.overloads[arguments]
    return int(result.library.get_pointer_to_function(result.fndesc.llvm_func_name))


def _exists(stage: Stage, group: Group) -> bool:
    arguments = _argument_types(stage, group)
    function: Any = stage.function
    if arguments in function.overloads:
        return True
    return function._cache.load_overload(arguments, function.targetctx) is not None


def _argument_types(stage: Stage, group: Group) -> tuple[Any, Any]:
    layout, _ = _layout(group)
    fields = tuple(field for field in layout[1] if field[0] in stage.fields)
    return LanesType(("record", fields), group.stride), types.intp


def _calling(_: Any, address: Any, block: Any, count: Any) -> Any:
    """Call a stage by its address; so the loop over the samples is compiled once for all stages."""

    def generate(context: Any, builder: Any, sig: Any, arguments: Any) -> Any:
        ir: Any = cgutils.ir
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


_call_stage: Callable[[int, int, int], None] = make_intrinsic(_calling)


@compiled
def run_stages(
    stages: np.ndarray,
    block: int,
    noise_rows: np.ndarray,
    noise: np.ndarray,
    first: int,
    last: int,
    transient: int,
) -> None:
    """Run the samples from ``first`` to before ``last``; ``noise`` (lanes, samples, channels)."""
    width, _, channels = noise.shape
    for k in range(first, last):
        for channel in range(channels):
            for i in range(width):
                noise_rows[channel, i] = noise[i, k - first, channel]
        part = 0 if k < transient // 2 else 1 if k < transient else 2
        for stage in stages[part]:
            if stage != 0:
                _call_stage(stage, block, width)
