"""The control system of a loop as C: estimator, friction observer, guard and controller.

Three files: ``loop.h``, ``loop.c`` and ``loop_test.c``, which replays a simulated run. The C is
translated from the functions that nodes and simulation run (:mod:`furuta.export.functions`), for
the method, the compensation and the mode that the parameters select.
"""

from __future__ import annotations

from math import expm1
from typing import Any

from furuta.export.functions import CFunction, Translation
from furuta.export.structures import initialisation, structures
from furuta.export.text import comment
from furuta.export.values import REAL, Array, ExportError, Known, Memory, Precision, Value
from furuta.export.vectors import test_program
from furuta_control.control import ControllerMemory, forget_integrals
from furuta_hw.rigs.rig import Rig
from furuta_model.parameters import declared, values
from furuta_sim.simulation.closed_loop import Loop
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

_HEADER = """\
{about}
#ifndef FURUTA_LOOP_H
#define FURUTA_LOOP_H

#include <stdbool.h>
#include <stdint.h>

#define LOOP_REAL {real}

/* Time between two calls of loop_step [s]. */
#define LOOP_SAMPLE_TIME {sample_time}

/* Calibration of the rig: value = (code - zero) * per_code [rad, rad/s, rad, V]. */
{calibration}

/* What the sensors say; NAN where a reading is missing or there is no sensor. */
typedef struct {{
    {real} phi;       /* arm angle [rad] */
    {real} phi_dot;   /* arm speed [rad/s] */
    {real} theta;     /* pendulum angle, 0 upright [rad] */
    {real} theta_dot; /* pendulum speed [rad/s], NAN unless all sensors are ideal */
    {real} torque;    /* voltage that the drive has applied since the reading before [V] */
}} loop_reading;

/* The command, and what it was computed from. */
typedef struct {{
    {real} voltage;     /* command u [V] */
    {real} friction;    /* friction estimate [V] */
    {real} estimate[5]; /* phi, phi_dot, theta, theta_dot, observed friction; NAN if unknown */
}} loop_command;

{structures}

/* All that the loop remembers. */
typedef {memory} loop_memory;

#ifdef __cplusplus
extern "C" {{
#endif

/* Prepare for the first reading. */
void loop_init(loop_memory *memory);

/* One sample: the command for a reading. */
void loop_step(loop_memory *memory, const loop_reading *reading, loop_command *command);

/* Prepare for a reading that does not continue the ones before; what has been learned is kept. */
void loop_reset(loop_memory *memory);

/* Call it before loop_step while commands are not applied: nothing is integrated meanwhile. */
void loop_forget_integrals(loop_memory *memory);

#ifdef __cplusplus
}}
#endif

#endif
"""

_SOURCE = """\
/* Generated with loop.h, which says from what. Integers have 64 bits, as in the original. */
#include "loop.h"

#if defined(__FAST_MATH__)
#error "compile without fast-math: NAN marks what is not known"
#endif
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#endif

#if __STDC_HOSTED__
#include <math.h>
#else /* the compiler's own */
#define NAN __builtin_nanf("")
#define isnan(x) __builtin_isnan(x)
#define copysign{s} __builtin_copysign{s}
#define fabs{s} __builtin_fabs{s}
#define floor{s} __builtin_floor{s}
#define fma{s} __builtin_fma{s}
#define sqrt{s} __builtin_sqrt{s}
#endif

{constants}

{functions}

void loop_init(loop_memory *memory) {{
    const loop_memory zero = {{0}};
    *memory = zero;{initial}
}}

void loop_step(loop_memory *memory, const loop_reading *reading, loop_command *command) {{
    {real} measurement[5] = {{
        reading->phi, reading->phi_dot, reading->theta, reading->theta_dot, reading->torque,
    }};
    const {step}_result result = {step}(memory, measurement, command->estimate);
    command->friction = result.part0;
    command->voltage = result.part1;
}}

void loop_reset(loop_memory *memory) {{
    {reset}(memory);
}}

void loop_forget_integrals(loop_memory *memory) {{
    {forget_integrals}(&memory->controller);
}}
"""


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
    step = _translated(
        whole,
        control_sample,
        memory,
        measurement,
        Known(_design(loop, precision), "loop"),
        estimate,
    )
    reset_loop = _translated(whole, reset, memory)
    forget = _translated(whole, forget_integrals, Memory(ControllerMemory, "memory", "memory->"))
    code = "\n\n".join(whole.code)
    code = "\n\n".join([*whole.helpers(code), code])
    source = _SOURCE.format(
        s=precision.suffix,
        real=precision.name,
        constants=whole.constants.text(code),
        functions=code,
        initial=initialisation(whole, ControlMemory),
        step=step.name,
        reset=reset_loop.name,
        forget_integrals=forget.name,
    )
    header = _HEADER.format(
        about=_description(loop, origin),
        calibration=_calibration(rig, precision),
        sample_time=precision.literal(loop.controller.sample_time),
        real=precision.name,
        structures=structures(whole, ControlMemory),
        memory=whole.structure_name(ControlMemory),
    )
    return {"loop.h": header, "loop.c": source, "loop_test.c": test_program(loop, precision)}


def _translated(whole: Translation, function: Any, *arguments: Value) -> CFunction:
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


def _description(loop: Loop, origin: str) -> str:
    """A comment with all parameters, their units and meanings."""
    lines = [origin]
    groups: dict[str, Any] = {
        "estimator": loop.estimator,
        "friction_observer": loop.observer,
        "controller": loop.controller,
    }
    for node, group in groups.items():
        lines.append(f"{node}:")
        given = values(group)
        for name, _, _, about in declared(type(group)):  # type: ignore[arg-type]
            meaning = about.meaning.partition(";")[0]
            lines.append(f"  {name} = {given[name]} {about.unit}".rstrip() + f": {meaning}")
    texts = (comment(line)[3:].removesuffix(" */") for line in lines)
    return "/* " + "\n * ".join(texts) + "\n */"
