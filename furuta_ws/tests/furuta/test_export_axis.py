"""Exported C of a joint gives the commands of node and simulation, as that of the pendulum does."""

from __future__ import annotations

import ctypes
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from exported_loop import (
    EXAMPLES,
    PRECISIONS,
    OnProcessor,
    assert_gain_is_tested,
    assert_small,
    compile_controller,
    load,
)

from furuta.axis.axis import Cascade, Pid
from furuta.axis.joint_file import JointFile
from furuta.axis.servo import ServoMemory, design_servo
from furuta.export.axis_files import axis_files, run_servo
from furuta.export.values import DOUBLE, FLOAT, Precision
from furuta_friction.joint_observer import ObserverNodeParameters, reset
from furuta_model.block import block, new_memory
from furuta_model.compiled import compiled
from furuta_model.parameters import ParameterError, build

pytest.importorskip("ziglang", reason="pip install -r firmware/requirements.lock")
pytest.importorskip("unicorn", reason="pip install -r firmware/requirements.lock")

# An elbow with gravity [N m, rad].
COUNT, INERTIA, LEVEL, STIFFNESS = 1e-4, 0.2, 2.0, 20000.0
ELBOW = {
    "joint": "elbow", "sample_time": 0.002, "compensation": "lugre",
    "alpha0": LEVEL, "alpha1": 0.5, "stribeck_velocity": 0.05, "asymmetry": 0.1,
    "sigma0": STIFFNESS, "sigma1": 50.0, "observer_gain": 0.0,
    "axis.inertia": INERTIA, "axis.viscous": 0.3, "axis.gravity_sin": 6.0,
    "axis.resolution": COUNT, "axis.friction_process_noise": 3.0,
}  # fmt: skip
PID, CASCADE = Pid(40.0, 60.0, 4.0), Cascade(8.0, 5.0, 20.0)
USUAL: dict[str, tuple[Any, dict[str, Any]]] = {
    "lugre": (PID, {}),
    "coulomb": (CASCADE, {"compensation": "coulomb"}),
    "adaptive": (None, {"compensation": "adaptive", "axis.gravity_cos": -2.0}),
    "recommended": (CASCADE, {"compensation": "recommended", "axis.offset": 0.5}),
    "late": (PID, {"compensation": "recommended", "drive.delay": 3, "drive.lag": 0.01}),
    "unknown_inertia": (None, {"axis.inertia": 0.0, "viscous": 0.3}),
}
FURTHER: dict[str, tuple[Any, dict[str, Any]]] = {
    "none": (CASCADE, {"compensation": "none"}),
    "stiction": (PID, {"compensation": "stiction"}),
}
CASES = USUAL | FURTHER
CALLS = Path(__file__).parents[1] / "export_axis.c"
# Samples between which a joint may rest.
PART = 200
# Probabilities per sample of an unknown number, no reference, one that rests, and a reset.
UNKNOWN, NONE, RESTING, ANEW = 0.02, 0.05, 0.2, 5e-4


class Run(NamedTuple):
    """Position, speed, torque, reference and its speed (n, 5), and resets (n,)."""

    given: np.ndarray
    resets: np.ndarray


def joint_of(case: str) -> JointFile:
    controller, values = CASES[case]
    return JointFile("elbow", ELBOW | values, controller)


def random_run(samples: int) -> Run:
    """A joint that moves at random and rests now and then, read in counts."""
    random, dt = np.random.default_rng(samples), ELBOW["sample_time"]

    def chosen(probability: float) -> np.ndarray:
        return random.random(samples) < probability

    def held(values: np.ndarray, changes: np.ndarray) -> np.ndarray:
        """The value at the last change."""
        return values[np.maximum.accumulate(np.where(changes, np.arange(len(values)), 0))]

    resets = chosen(ANEW)
    knots = random.uniform(-1.0, 1.0, samples // PART + 2)
    knots = held(knots, random.random(len(knots)) < 0.7)
    path = np.interp(np.arange(samples) / PART, np.arange(len(knots)), knots)
    path = np.convolve(path, np.full(PART // 2, 2.0 / PART), "same")
    speed = np.gradient(path, dt)
    path += held(random.uniform(-1.0, 1.0, samples), resets)
    position = COUNT * np.floor(path / COUNT)
    torque = INERTIA * np.gradient(speed, dt) + LEVEL * np.tanh(speed / 0.01)
    torque += 6.0 * np.sin(position) + random.standard_normal(samples)
    torque[chosen(UNKNOWN)] = np.nan
    position[1:][chosen(UNKNOWN)[1:] & ~resets[1:]] = np.nan
    reference = path + 0.01 * random.standard_normal(samples)
    reference_speed = np.where(chosen(RESTING), 0.0, speed + 0.1 * random.standard_normal(samples))
    reference_speed[chosen(NONE)] = np.nan
    measured_speed = speed + 0.01 * random.standard_normal(samples)
    measured_speed[chosen(UNKNOWN)] = np.nan
    given = position, measured_speed, torque, reference, reference_speed
    return Run(np.column_stack(given), resets)


def computed(joint: JointFile, run: Run) -> np.ndarray:
    """Commands and friction estimates (n, 2) as node and simulation compute them."""
    parameters = build(ObserverNodeParameters, joint.parameters)
    design = block(design_servo(joint.controller or Pid(0.0), parameters))
    memories = new_memory(ServoMemory), new_memory(ServoMemory)
    results, ends = np.empty((len(run.given), 2)), [*np.flatnonzero(run.resets), len(run.given)]
    for begin, end in pairwise([0, *ends]):
        run_servo(*memories, run.given[begin:end], design, results[begin:end])
        for memory in memories:
            _reset(memory)
    return results


@compiled
def _reset(memory: np.ndarray) -> None:
    reset(memory[0].observer)


def write_axis(joint: JointFile, directory: Path, precision: Precision = DOUBLE) -> None:
    for name, content in axis_files(joint, precision, "Joint of a test.").items():
        (directory / name).write_text(content)


def compiled_results(
    joint: JointFile, run: Run, directory: Path, precision: Precision = DOUBLE
) -> np.ndarray:
    """Commands and friction estimates (n, 2) of the exported code."""
    write_axis(joint, directory, precision)
    library = load(directory, directory / "axis.c", CALLS)
    real = np.float32 if precision is FLOAT else np.float64
    given, results = run.given.astype(real), np.empty((2, len(run.given)), real)
    for call, result in zip((library.call_step, library.call_friction), results, strict=True):
        memory = np.zeros(library.memory_size(), dtype=np.uint8)
        where = ctypes.c_void_p(memory.ctypes.data)
        library.axis_init(where)
        call.argtypes = [ctypes.c_void_p] * 3
        for k, anew in enumerate(run.resets.tolist()):
            if anew:
                library.axis_reset(where)
            from_, to = given.ctypes.data + k * given.strides[0], result.ctypes.data
            call(where, from_, to + k * result.itemsize)
    return results.T


def assert_same(case: str, samples: int, directory: Path) -> None:
    """The same bits, or NaN; many different commands."""
    joint, run = joint_of(case), random_run(samples)
    expected = computed(joint, run)
    results = compiled_results(joint, run, directory)
    assert np.array_equal(results, expected, equal_nan=True)
    assert len(np.unique(expected)) > 1000


@pytest.mark.parametrize("case", USUAL)
def test_commands_have_the_same_bits(case: str, tmp_path: Path) -> None:
    """Of ``axis_step`` and ``axis_friction``, with unknown torques and speeds, and resets."""
    assert_same(case, 25_000, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("case", CASES)
def test_commands_have_the_same_bits_for_long(case: str, tmp_path: Path) -> None:
    """A million samples of each case."""
    assert_same(case, 1_000_000, tmp_path)


@pytest.mark.parametrize(
    "case",
    [
        "lugre",
        pytest.param(
            "recommended",
            marks=pytest.mark.xfail(
                strict=True,
                reason="its level is learned by the sign of a speed that rounding turns",
            ),
        ),
    ],
)
def test_floats_deviate_little(case: str, tmp_path: Path) -> None:
    """On the same samples, less than a hundredth of a count would make as force of the bristle."""
    joint, run = joint_of(case), random_run(25_000)
    results, expected = compiled_results(joint, run, tmp_path, FLOAT), computed(joint, run)
    assert np.array_equal(np.isnan(results), np.isnan(expected))
    assert np.nanmax(np.abs(results - expected)) < 0.01 * COUNT * STIFFNESS


@pytest.mark.parametrize(
    ("case", "precision", "gain"),
    [
        ("lugre", "float", "feedback_speed"),
        ("recommended", "double", "feedback_error"),
        ("unknown_inertia", "double", "compensation_joint_friction_alpha0"),
    ],
)
def test_the_test_program_finds_a_wrong_gain(
    case: str, precision: str, gain: str, tmp_path: Path
) -> None:
    write_axis(joint_of(case), tmp_path, PRECISIONS[precision])
    assert_gain_is_tested(tmp_path, "axis", gain)


@pytest.mark.parametrize(("case", "precision"), [("late", "float"), ("recommended", "double")])
def test_size_on_other_processors(case: str, precision: str, tmp_path: Path) -> None:
    write_axis(joint_of(case), tmp_path, PRECISIONS[precision])
    assert_small(tmp_path / "axis.c", precision, 1000, 15_000)


@pytest.mark.parametrize("precision", PRECISIONS)
def test_ros2_control_example_compiles(precision: str, tmp_path: Path) -> None:
    """Against stand-ins for the headers of ros2_control, which are not installed here."""
    write_axis(joint_of("lugre"), tmp_path, PRECISIONS[precision])
    compile_controller(tmp_path, EXAMPLES / "joint_friction_controller.cpp")


def test_cost_on_a_cortex_m4(tmp_path: Path) -> None:
    """Floats have the bits of this computer's; below 1000 instructions in a usual sample."""
    joint, run = joint_of("lugre"), random_run(1500)
    run = run._replace(resets=np.zeros_like(run.resets))
    expected = compiled_results(joint, run, tmp_path, FLOAT)
    for function, results in zip(("call_step", "call_friction"), expected.T, strict=True):
        machine = OnProcessor(tmp_path, "axis", CALLS, "call_step")
        costs = machine.costs(function, run.given, results)
        assert 200 < np.median(costs) < 1000
        assert max(costs) < 3000


def test_a_missing_position_is_predicted() -> None:
    """Two samples without one are as two that read what was predicted; before the first: NaN."""
    joint = joint_of("lugre")
    whole = np.zeros((400, 5))
    whole[:, 0] = 0.1 * np.sin(0.01 * np.arange(400))
    gap, unknown = whole.copy(), whole.copy()
    gap[200:202, 0] = unknown[0, 0] = np.nan
    read, predicted = (computed(joint, Run(given, np.zeros(400)))[:, 0] for given in (whole, gap))
    assert np.array_equal(read[:200], predicted[:200]) and not np.isnan(predicted).any()
    assert np.abs(read - predicted)[200:].max() < 0.05 * np.ptp(read)
    assert np.isnan(computed(joint, Run(unknown, np.zeros(400)))[0, 0])


@pytest.mark.parametrize(
    ("values", "controller", "message"),
    [
        ({"sample_time": 5.0}, None, "sample_time must be .*5"),
        ({"axis.inertia": 0.0}, PID, "elbow has a controller.*axis.inertia must be above 0"),
    ],
)
def test_what_is_refused(values: dict[str, Any], controller: Any, message: str) -> None:
    """With one line that says what is allowed."""
    joint = JointFile("elbow", ELBOW | values, controller)
    with pytest.raises(ParameterError, match=message):
        axis_files(joint, DOUBLE, "")
