"""The control system of a loop as C: estimator, friction observer and controller.

Three files: ``loop.h``, ``loop.c`` and ``loop_test.c``, which replays a simulated run. The C is
translated from the functions that nodes and simulation run (:mod:`furuta.export.functions`), for
the method, the compensation and the mode that the parameters select.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import expm1
from typing import Any

import numpy as np

from furuta.export.functions import CFunction, Translation
from furuta.export.structures import initialisation, structures
from furuta.export.text import comment, filled
from furuta.export.values import DOUBLE, REAL, Array, ExportError, Known, Memory, Precision, Value
from furuta_control.control import ControllerMemory, forget_integrals
from furuta_hw.rigs.rig import Rig
from furuta_model.parameters import declared, values
from furuta_model.parts.disturbances import Pushes
from furuta_model.parts.sensor_faults import SensorFaults
from furuta_model.sensors import measure
from furuta_sim.parameters import PlantParameters
from furuta_sim.plant import Noise
from furuta_sim.simulation.closed_loop import Loop, Record, simulate
from furuta_sim.simulation.control_system import (
    ControlMemory,
    ControlSystem,
    control_sample,
    design_control_system,
    reset,
)

PREFIX = "loop_"
# Modes that feed the state back.
MODES = ("balance", "swing_up")
# Tolerance of floats for rounding, relative.
FLOAT_ROUNDING = 1e-6
# Of the run that the test replays.
SAMPLES = 500
# A push on the pendulum that lets it fall: when and how long [s], relative to its weight.
PUSH_BEGIN, PUSH_TIME, PUSH_SIZE = 0.15, 0.1, 1.0
# Deviation of a float's command that counts as rounding, relative to the voltage limit.
FLOAT_TOLERANCE = 1e-3


def loop_files(loop: Loop, rig: Rig, precision: Precision, origin: str) -> dict[str, str]:
    """Header, source and test by file name; ``origin`` says where the parameters are from.

    ``rig`` gives the calibration of sensors and drive, for those who have their codes.

    Raises:
        ParameterError: Something in the loop cannot be exported.
    """
    _check(loop)
    whole = Translation(precision, PREFIX)
    memory = Memory(ControlMemory, "memory", "memory->")
    measurement, estimate = (Array(REAL, n) for n in ("measurement", "estimate"))
    step = translated(
        whole,
        control_sample,
        memory,
        measurement,
        Known(_design(loop, precision), "loop"),
        estimate,
    )
    reset_loop = translated(whole, reset, memory)
    forget = translated(whole, forget_integrals, Memory(ControllerMemory, "memory", "memory->"))
    source = filled(
        "loop.c",
        **parts_of_source(whole),
        initial=initialisation(whole, ControlMemory),
        step=step.name,
        reset=reset_loop.name,
        forget_integrals=forget.name,
    )
    groups = {
        "estimator": loop.estimator,
        "friction_observer": loop.observer,
        "controller": loop.controller,
    }
    header = filled(
        "loop.h",
        about=description(groups, origin),
        calibration=_calibration(rig, precision),
        sample_time=precision.literal(loop.controller.sample_time),
        real=precision.name,
        structures=structures(whole, ControlMemory),
        memory=whole.structure_name(ControlMemory),
    )
    return {"loop.h": header, "loop.c": source, "loop_test.c": _test_program(loop, precision)}


def translated(whole: Translation, function: Any, *arguments: Value) -> CFunction:
    """Translate a function for arguments in its order."""
    python = getattr(function, "py_func", function)
    names = python.__code__.co_varnames
    return whole.function(python, dict(zip(names, arguments, strict=False)))


def _check(loop: Loop) -> None:
    """Refuse what is for experiments only."""
    if loop.controller.mode not in MODES:
        raise ExportError(
            f"controller.mode must be one of {', '.join(MODES)} to be exported, given "
            f"{loop.controller.mode}"
        )
    if loop.controller.excitation.kind != "none":
        raise ExportError(
            "excitation.kind must be none to be exported: the signal is for identification; given "
            f"{loop.controller.excitation.kind}"
        )


def _design(loop: Loop, precision: Precision) -> ControlSystem:
    """The control system, with limits of the readings that allow for the rounding of floats."""
    system = design_control_system(loop.estimator, loop.observer, loop.controller)
    if not precision.suffix:
        return system
    limits = system.estimator.readings
    limits = limits._replace(
        end=limits.end * (1.0 - FLOAT_ROUNDING), largest=limits.largest * (1.0 + FLOAT_ROUNDING)
    )
    return system._replace(estimator=system.estimator._replace(readings=limits))


def _calibration(rig: Rig, precision: Precision) -> str:
    """Macros for the channels of a rig.

    The share is that of a new difference in the low-pass filter on the arm's speed, 0 with a
    tachometer.
    """
    parts: dict[str, Any] = {
        "arm": rig.arm,
        "speed": rig.speed,
        "pendulum": rig.pendulum,
        "drive": rig.drive,
    }
    macros: dict[str, str | int] = {}
    for name, part in parts.items():
        macros[f"{name}_per_code"] = precision.literal(part.channel.per_code)
        macros[f"{name}_zero"] = precision.literal(part.channel.zero)
    tachometer = rig.speed.sensor == "tachometer"
    share = 0.0 if tachometer else -expm1(-rig.speed.bandwidth * rig.line.sample_time)
    macros["speed_share"] = precision.literal(share)
    macros |= {"drive_low": rig.drive.channel.low, "drive_high": rig.drive.channel.high}
    return "\n".join(f"#define LOOP_{name.upper()} {value}" for name, value in macros.items())


def parts_of_source(whole: Translation) -> dict[str, str]:
    """What the template of a source needs of a translation."""
    code = "\n\n".join(whole.code)
    code = "\n\n".join([*whole.helpers(code), code])
    return {
        "preamble": filled("preamble.c", s=whole.precision.suffix).strip(),
        "real": whole.precision.name,
        "constants": whole.constants.text(code),
        "functions": code,
    }


def description(
    groups: Mapping[str, Any], origin: str, without: tuple[str, ...] = (), force: str = "V"
) -> str:
    """A comment with parameters of nodes, their units and meanings.

    Those of the pendulum can be left out by the beginnings of their names; ``force`` is the unit in
    place of V.
    """
    lines = [origin]
    for node, group in groups.items():
        lines.append(f"{node}:")
        given = values(group)
        for name, _, _, about in declared(type(group)):  # type: ignore[arg-type]
            if without and name.startswith(without):
                continue
            value, unit = given[name], about.unit.replace("V", force)
            meaning = _meaning(about.meaning, value).replace("0 V", f"0 {force}")
            lines.append(f"  {name} = {value} {unit}".rstrip() + meaning)
    texts = (comment(line)[3:].removesuffix(" */") for line in lines)
    return "/* " + "\n * ".join(texts) + "\n */"


def _meaning(text: str, value: Any) -> str:
    """The meaning of a parameter, or of the choice that is its value."""
    parts = text.split("; ")
    if isinstance(value, str) and ": " in parts[0]:
        return next((part[len(value) :] for part in parts if part.startswith(f"{value}: ")), "")
    return f": {parts[0]}"


def _test_program(loop: Loop, precision: Precision) -> str:
    """Replays a simulated run and compares the commands: in double the last bit must agree."""
    size = PUSH_SIZE * loop.plant.model.delta
    push = Pushes(times=(PUSH_BEGIN,), durations=(PUSH_TIME,), pendulum=(size,))
    plant = loop.plant._replace(pushes=push, sensor_faults=SensorFaults())
    run = simulate(loop._replace(plant=plant), SAMPLES * plant.sample_time)
    return filled(
        "loop_test.c",
        real=precision.name,
        samples=SAMPLES,
        readings=rows(_readings(run, plant).tolist(), precision),
        expected=rows(np.column_stack([run.command, run.friction_estimate]).tolist(), DOUBLE),
        tolerance=FLOAT_TOLERANCE * loop.controller.voltage_limit if precision.suffix else 0.0,
    )


def _readings(run: Record, plant: PlantParameters) -> np.ndarray:
    """What the sensors said (n, 5); the record has what the estimator made of it."""
    readings = run.measurement.copy()
    noise = Noise(plant.seed)
    for state, reading in zip(run.state, readings, strict=True):
        measure(state, noise(), plant.sensors, reading)
    return readings


def rows(numbers: Iterable[list[float]], precision: Precision) -> str:
    """Rows of numbers as the initial values of an array."""
    return "\n".join("    {" + ", ".join(map(precision.literal, row)) + "}," for row in numbers)
