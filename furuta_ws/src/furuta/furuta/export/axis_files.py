"""Controller and friction compensation of an axis as C, from a joint file.

Three files: ``axis.h``, ``axis.c`` and ``axis_test.c``, which compares a run. The C is translated
from the sample that node and simulation compute (:mod:`furuta.axis.servo`).
"""

from __future__ import annotations

from math import pi

import numpy as np

from furuta.axis.axis import Pid
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
from furuta_model.parameters import ParameterError, build

PREFIX = "axis_"
# Of the run that the test compares; its motion is this many turns at this frequency [Hz].
SAMPLES, TURNS, FREQUENCY = 500, 0.1, 2.0
# Position and speed, relative to the reference's.
LAGGING = 0.9
# Parameters that a joint of its own does not have, by the beginnings of their names.
OF_PENDULUM = "model", "viscous", "observer_gain", "joint"
STEP = "position", "torque", "reference", "reference_speed"
FRICTION = "position", "speed", "torque", "reference_speed"


def axis_files(joint: JointFile, precision: Precision, origin: str) -> dict[str, str]:
    """Header, source and test by file name; ``origin`` says where the parameters are from.

    Raises:
        ParameterError: A parameter is not allowed, or something cannot be exported.
    """
    parameters = build(ObserverNodeParameters, joint.parameters)
    if joint.controller is not None and not parameters.axis.inertia:
        raise ParameterError(
            f"{joint.joint} has a controller, which takes its speed from the observer: "
            "axis.inertia must be above 0"
        )
    design = design_servo(joint.controller or Pid(0.0), parameters, joint.rule)
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
        unused_by_step=_unused(STEP, step),
        unused_by_friction=_unused(FRICTION, friction),
    )
    header = filled(
        "axis.h",
        about=description({joint.joint: parameters}, origin, OF_PENDULUM, "N m"),
        real=precision.name,
        sample_time=precision.literal(design.dt),
        structures=structures(whole, ServoMemory).replace("[V", "[N m"),
        memory=whole.structure_name(ServoMemory),
        controller=comment(_about(joint)),
    )
    return {"axis.h": header, "axis.c": source, "axis_test.c": _test_program(design, precision)}


def _about(joint: JointFile) -> str:
    """What ``axis_step`` computes, with the gains and the rule of the integral."""
    if joint.controller is None:
        return "One sample: the friction estimate alone, as the joint file has no controller."
    kind, named, rule = type(joint.controller).__name__, joint.controller._asdict(), joint.rule
    gains = ", ".join(f"{n} {value:g}" for n, value in named.items() if n != "filter_time")
    rules = [
        f"pauses while the error is below {rule.dead_band:g} rad" * bool(rule.dead_band),
        "becomes the known load where the error changes its sign" * rule.resets,
        f"differs from the load by {rule.limit:g} N m at most while the axis moves"
        * bool(rule.limit),
    ]
    told = ", ".join(filter(None, rules))
    return (
        f"One sample: the command of the {kind.lower()} controller ({gains}), with the friction "
        "estimate in it. It is not limited. The speed is that of the observer."
    ) + (f" While reference_speed is 0, the integral {told}." if told else "")


def _unused(names: tuple[str, ...], function: CFunction) -> str:
    """Statements that name the arguments that a function does not need."""
    return "".join(f"    (void){name};\n" for name in names if name not in function.parameters)


def _call(function: CFunction) -> str:
    """A call with the arguments of the interface."""
    pointers = {"memory": "&memory->observer" if "observer" in function.name else "memory"}
    return f"{function.name}({', '.join(pointers.get(n, n) for n in function.parameters)})"


def _test_program(design: ServoDesign, precision: Precision) -> str:
    """A sine that is measured in counts, and the commands and friction estimates for it."""
    time, turn = design.dt * np.arange(SAMPLES), 2.0 * pi
    reference = TURNS * turn * np.sin(turn * FREQUENCY * time)
    speed, count = np.gradient(reference, time), design.observer.model.resolution
    position = count * np.floor(LAGGING * np.roll(reference, 5) / count)
    given = np.column_stack([position, LAGGING * speed, np.zeros(SAMPLES), reference, speed])
    if precision.suffix:
        given = given.astype(np.float32).astype(float)
    expected = np.empty((SAMPLES, 2))
    run_servo(new_memory(ServoMemory), new_memory(ServoMemory), given, block(design), expected)
    largest = float(np.max(np.abs(expected)))
    return filled(
        "axis_test.c",
        real=precision.name,
        samples=SAMPLES,
        given=rows(given.tolist(), precision),
        expected=rows(expected.tolist(), DOUBLE),
        tolerance=FLOAT_TOLERANCE * largest if precision.suffix else 0.0,
    )


@compiled
def run_servo(
    of_step: np.ndarray,
    of_friction: np.ndarray,
    given: np.ndarray,
    p: np.ndarray,
    results: np.ndarray,
) -> None:
    """Write commands and friction estimates (n, 2).

    ``given`` (n, 5) has position, speed, torque, reference and its speed. Each result has its own
    memory.
    """
    for k in range(len(given)):
        position, speed, torque, reference, of_reference = given[k]
        results[k, 0] = servo_sample(of_step[0], position, torque, reference, of_reference, p[0])
        results[k, 1] = joint_friction(
            of_friction[0].observer, position, speed, torque, of_reference, p[0].observer
        )
