"""Translates the closed loop of the page to C, for all laws, compensations and modes it offers."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from adjustable import Adjustable
from page_designs import BASE, PUSHES, SELECTING, Design, Group, design_of

from furuta.export.functions import CFunction, Translation
from furuta.export.structures import initialisation, structures
from furuta.export.text import filled_text
from furuta.export.values import DOUBLE, REAL, Array, Known, Memory, Number
from furuta.export.values import Group as Parts
from furuta_model.parts.plant_memory import PlantMemory
from furuta_sim.plant import move, read, true_friction
from furuta_sim.simulation.control_system import ControlMemory, control_sample, reset


class Page(NamedTuple):
    """The C code, the place of each number in ``design``, and the variants by what selects them."""

    code: str
    places: dict[str, int]
    laws: dict[str, int]
    controls: dict[str, int]


def selected(design: Design, part: str) -> str:
    """What selects the variant of the plant or of the control system."""
    numbers = design.numbers.items()
    return " ".join(
        f"{value}" for name, value in numbers if name.startswith(part) and name in SELECTING
    )


def places_of(groups: Iterable[Group], base: Design) -> dict[str, int]:
    """The index in ``design`` of each number that can change."""
    names = dict.fromkeys(n for group in groups for n in group.numbers if n not in SELECTING)
    places, end = {}, 0
    for name in (*names, PUSHES):
        places[name], end = end, end + np.size(base.numbers[name])
    return places


def translated(groups: list[Group]) -> Page:
    """The loop in C."""
    base = design_of(BASE)
    places = places_of(groups, base)
    whole = Translation(DOUBLE, "loop_", Adjustable(DOUBLE, places, "design"))
    plant = Memory(PlantMemory, "&plant_memory", "plant_memory.")
    control = Memory(ControlMemory, "&control_memory", "control_memory.")
    signals = [Array(REAL, name) for name in ("noise", "measurement", "estimate")]
    noise, measurement, estimate = signals
    measure = _call(whole, read, plant, noise, Known(base.plant, "plant"), measurement)
    laws: dict[str, int] = {}
    law_cases: list[str] = []
    for design in groups[0].designs:
        if selected(design, "plant") not in laws:
            law_cases.append(_law_case(whole, plant, design, len(laws)))
            laws[selected(design, "plant")] = len(laws)
    controls: dict[str, int] = {}
    control_cases: list[str] = []
    for design in groups[-1].designs:
        if selected(design, "control") not in controls:
            known = Known(design.control, "control")
            call = _call(whole, control_sample, control, measurement, known, estimate)
            control_cases.append(_control_case(call, len(controls)))
            controls[selected(design, "control")] = len(controls)
    own = Memory(ControlMemory, "memory", "memory->")
    forget = _function(whole, reset, own)
    whole.used_fields |= {(PlantMemory, "x"), (PlantMemory, "moved")}
    code = "\n\n".join(whole.code)
    code = "\n\n".join([*whole.helpers(code), code])
    text = filled_text(
        (Path(__file__).parent / "page" / "loop.c").read_text(),
        size=places[PUSHES] + base.numbers[PUSHES].size,
        constants=whole.constants.text(code),
        structures=structures(whole, PlantMemory, ControlMemory),
        functions=code,
        initial=initialisation(whole, ControlMemory),
        reset=forget.name,
        read=measure[0],
        controls="\n".join(control_cases),
        laws="\n".join(law_cases),
    )
    return Page(text, places, laws, controls)


def _function(whole: Translation, function: Any, *arguments: Any) -> CFunction:
    python = getattr(function, "py_func", function)
    names = python.__code__.co_varnames
    return whole.function(python, dict(zip(names, arguments, strict=False)))


def _call(whole: Translation, function: Any, *arguments: Any) -> tuple[str, CFunction]:
    """The text of a call with these arguments, and the function."""
    done = _function(whole, function, *arguments)
    python = getattr(function, "py_func", function)
    given = dict(zip(python.__code__.co_varnames, arguments, strict=False))
    return f"{done.name}({', '.join(given[name].text for name in done.parameters)})", done


def _law_case(whole: Translation, plant: Memory, design: Design, number: int) -> str:
    known = Known(design.plant, "plant")
    friction, _ = _call(whole, true_friction, plant, known)
    moved, _ = _call(whole, move, plant, Number(REAL, "command"), known)
    return (
        f"    case {number}:\n        signals[10] = {friction};\n        applied = {moved};\n"
        "        break;"
    )


def _control_case(call: tuple[str, CFunction], number: int) -> str:
    text, done = call
    assert isinstance(done.result, Parts)
    estimated, command = (
        each.text if each.is_constant else f"result.part{i}"
        for i, each in enumerate(done.result.values)
    )
    return (
        f"    case {number}: {{\n        const {done.name}_result result = {text};\n"
        f"        friction_estimate = {estimated};\n        command = {command};\n"
        "        break;\n    }"
    )
