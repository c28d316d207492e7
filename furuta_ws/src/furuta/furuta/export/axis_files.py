"""Controller and friction compensation of an axis as C, from a joint file.

Three files: ``axis.h``, ``axis.c`` and ``axis_test.c``, which compares a run. The C is translated
from the sample that node and simulation compute (:mod:`furuta.axis.servo`).
"""

from __future__ import annotations

from math import pi

import numpy as np

from furuta.axis.axis import Controller, Pid
from furuta.axis.joint_file import JointFile
from furuta.axis.servo import ServoDesign, ServoMemory, design_servo, servo_sample
from furuta.export.functions import CFunction, Translation
from furuta.export.loop_files import FLOAT_TOLERANCE, description, parts_of_source, rows, translated
from furuta.export.structures import initialisation, structures
from furuta.export.text import comment, filled
from furuta.export.values import DOUBLE, REAL, Known, Memory, Number, Precision
from furuta_friction.joint_observer import (
    JointMemory,
    ObserverNodeParameters,
    joint_friction,
    reset,
)
from furuta_model.block import block, new_memory
from furuta_model.compiled import compiled
from furuta_model.parameters import build

PREFIX = "axis_"
# Of the run that the test compares; its motion is this many turns at this frequency [Hz].
SAMPLES, TURNS, FREQUENCY = 500, 0.1, 2.0
STEP = "position", "torque", "reference", "reference_speed"
FRICTION = "position", "speed", "torque", "reference_speed"


def axis_files(joint: JointFile, precision: Precision, origin: str) -> dict[str, str]:
    """Header, source and test by file name; ``origin`` says where the parameters are from.

    Raises:
        ParameterError: A parameter is not allowed, or something cannot be exported.
    """
    parameters = build(ObserverNodeParameters, joint.parameters)
    controller = joint.controller or Pid(0.0)
    design = design_servo(controller, parameters)
    whole = Translation(precision, PREFIX)
    memory = Memory(ServoMemory, "memory", "memory->")
    observer = Memory(JointMemory, "&memory->observer", "memory->observer.")
    of_step, of_friction = ([Number(REAL, name) for name in names] for names in (STEP, FRICTION))
    step = translated(whole, servo_sample, memory, *of_step, Known(design, "axis"))
    friction = translated(
        whole, joint_friction, observer, *of_friction, Known(design.observer, "axis_observer")
    )
    anew = translated(whole, reset, observer)
    source = filled(
        "axis.c",
        **parts_of_source(whole),
        initial=initialisation(whole, ServoMemory),
        reset=_call(anew),
        step=_call(step),
        friction=_call(friction),
        unused="".join(f"    (void){n};\n" for n in FRICTION if n not in friction.parameters),
    )
    header = filled(
        "axis.h",
        about=description({"friction_observer": parameters}, origin),
        real=precision.name,
        sample_time=precision.literal(design.dt),
        structures=structures(whole, ServoMemory),
        memory=whole.structure_name(ServoMemory),
        controller=comment(
            f"One sample: the command of {_controller(joint.controller)}, with the friction "
            "estimate in it. torque is what the drive has applied since the sample before."
        ),
    )
    return {"axis.h": header, "axis.c": source, "axis_test.c": _test_program(design, precision)}


def _controller(controller: Controller | None) -> str:
    """A controller with its gains."""
    if controller is None:
        return "no controller"
    gains = ", ".join(f"{name} {value:g}" for name, value in controller._asdict().items())
    return f"a {type(controller).__name__.lower()} ({gains})"


def _call(function: CFunction) -> str:
    """A call with the arguments of the interface."""
    pointers = {"memory": "&memory->observer" if "observer" in function.name else "memory"}
    return f"{function.name}({', '.join(pointers.get(n, n) for n in function.parameters)})"


def _test_program(design: ServoDesign, precision: Precision) -> str:
    """A sine that is measured in counts, and the commands for it."""
    time, turn = design.dt * np.arange(SAMPLES), 2.0 * pi
    reference = TURNS * turn * np.sin(turn * FREQUENCY * time)
    count = design.observer.model.resolution
    position = count * np.floor(0.9 * np.roll(reference, 5) / count)
    given = np.column_stack([position, np.zeros(SAMPLES), reference, np.gradient(reference, time)])
    if precision.suffix:
        given = given.astype(np.float32).astype(float)
    expected = np.empty(SAMPLES)
    run_servo(new_memory(ServoMemory), given, block(design), expected)
    largest = float(np.max(np.abs(expected)))
    return filled(
        "axis_test.c",
        real=precision.name,
        samples=SAMPLES,
        given=rows(given.tolist(), precision),
        expected="\n".join(f"    {DOUBLE.literal(value)}," for value in expected.tolist()),
        tolerance=FLOAT_TOLERANCE * largest if precision.suffix else 0.0,
    )


@compiled
def run_servo(memory: np.ndarray, given: np.ndarray, p: np.ndarray, commands: np.ndarray) -> None:
    """Write the commands (n,) for positions, torques, references and their speeds (n, 4)."""
    for k in range(len(commands)):
        position, torque, reference, speed = given[k]
        commands[k] = servo_sample(memory[0], position, torque, reference, speed, p[0])
