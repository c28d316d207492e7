"""Reads rig files: YAML with a section for each part of a :class:`Rig`.

The model is given in one of three forms: ``model`` (α, β, γ, δ), ``linear`` (the four identified
coefficients of (3)) or ``physical``. The arm's travel is given as ``limits.arm_angle`` [rad] or as
``limits.arm_turns``. Values that a file does not give are those of the paper's rig.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from pathlib import Path
from typing import Annotated, Any, NamedTuple

from furuta_hw.rigs.physical import (
    PhysicalParameters,
    normalised_coulomb,
    normalised_model,
    normalised_viscous,
)
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.uncertainty import Uncertainty, uncertainty_from
from furuta_model.linear import from_linear
from furuta_model.parameters import About, ParameterError, build, declared, number_from_text
from furuta_model.pendulum import FurutaPendulum
from furuta_ros.yaml_files import read_yaml


class LinearCoefficients(NamedTuple):
    """The identified coefficients of the linear model (3)."""

    a23: Annotated[float, About("φ̈ per θ", "1/s²", high=0.0)] = -11.0
    a43: Annotated[float, About("θ̈ per θ", "1/s²", low=0.0)] = 33.0
    b21: Annotated[float, About("φ̈ per u", "rad/(V s²)", low=0.0)] = 45.0
    b41: Annotated[float, About("θ̈ per u", "rad/(V s²)", high=0.0)] = -29.0


# The arm's travel in turns, an alternative to ``limits.arm_angle`` in radians.
ARM_TURNS = "limits.arm_turns"
# Sections of a rig file that hold text for the reader, and one that has its own reader.
TEXT_SECTIONS = ("name", "sources", "notes")
UNCERTAINTY = "uncertainty"


def load_rig(file: Path) -> Rig:
    """Read a rig file. Raises :class:`ParameterError` with one line for any error."""
    return load_uncertain_rig(file)[0]


def load_uncertain_rig(file: Path) -> tuple[Rig, Uncertainty]:
    """Read a rig file with the uncertainty of its values. Raises as :func:`load_rig` does."""
    content = read_yaml(file, "rig file")
    if not isinstance(content, Mapping):
        raise ParameterError(f"rig file {file} must map sections to values")
    return rig_from_content(content, file)


def rig_from_content(content: Mapping[str, Any], file: Path) -> tuple[Rig, Uncertainty]:
    """The rig and the uncertainty that the ``content`` of a rig file describes."""
    try:
        rig = _rig(content)
        return rig, uncertainty_from(content.get(UNCERTAINTY), rig.waves)
    except ParameterError as error:
        raise ParameterError(f"{file}: {error}") from None


def is_rig_file(content: Mapping[Any, Any]) -> bool:
    """Whether the content of a YAML file is that of a rig file."""
    known = {*TEXT_SECTIONS, UNCERTAINTY, *_SECTIONS}
    return bool(content) and all(section in known for section in content)


def _rig(content: Mapping[str, Any]) -> Rig:
    """Build the rig from the content of its file."""
    given: dict[str, Any] = {}
    forms = [form for form in ("model", "linear", "physical") if form in content]
    if len(forms) > 1:
        raise ParameterError(f"give one of model, linear, physical, not {' and '.join(forms)}")
    for section, values in content.items():
        if section in (*TEXT_SECTIONS, UNCERTAINTY):
            continue
        if not isinstance(values, Mapping):
            raise ParameterError(f"{section} must map names to values")
        if section not in _SECTIONS:
            raise ParameterError(f"unknown: {section}.{next(iter(values), '')}")
        given |= {f"{section}.{name}": _numbers(value) for name, value in values.items()}
    given = _normalised(_with_arm_angle(given))
    known = [each.name for each in declared(Rig)]
    unknown = sorted(str(name) for name in given if name not in known)
    if unknown:
        raise ParameterError(f"unknown: {', '.join(unknown)}")
    return build(Rig, given)


def _numbers(value: Any) -> Any:
    """Text that is a number as such, in lists too."""
    if isinstance(value, list):
        return [number_from_text(each) for each in value]
    return number_from_text(value)


def _normalised(given: dict[str, Any]) -> dict[str, Any]:
    """Convert ``linear`` or ``physical`` to ``model``; explicitly given values take precedence."""
    linear = _section(given, LinearCoefficients, "linear")
    if linear is not None:
        if linear.b41 == 0.0:
            raise ParameterError("linear.b41 must be below 0")
        given = _model(from_linear(*linear)) | given
    physical = _section(given, PhysicalParameters, "physical")
    if physical is not None:
        friction = {"friction.viscous": normalised_viscous(physical)}
        if physical.friction_torque > 0.0:
            friction["friction.alpha0"] = normalised_coulomb(physical)
        given = _model(normalised_model(physical)) | friction | given
    return {name: v for name, v in given.items() if name.partition(".")[0] not in _FORMS}


_FORMS = ("linear", "physical")
_SECTIONS = {*_FORMS, *(each.name.partition(".")[0] for each in declared(Rig))}


def _with_arm_angle(given: dict[str, Any]) -> dict[str, Any]:
    """Convert ``limits.arm_turns``, which cables allow to either side, to ``limits.arm_angle``."""
    if ARM_TURNS not in given:
        return given
    if "limits.arm_angle" in given:
        raise ParameterError(f"give one of limits.arm_angle and {ARM_TURNS}")
    turns = given[ARM_TURNS]
    if isinstance(turns, bool) or not isinstance(turns, (int, float)) or not 0.0 < turns <= 1e5:
        raise ParameterError(f"{ARM_TURNS} must be above 0 and at most 100000, given {turns}")
    others = {name: value for name, value in given.items() if name != ARM_TURNS}
    return others | {"limits.arm_angle": 2.0 * pi * turns}


def _model(model: FurutaPendulum) -> dict[str, Any]:
    return {f"model.{name}": value for name, value in model._asdict().items()}


def _section(given: dict[str, Any], group: type[Any], name: str) -> Any:
    """Build the group from the section of that name; None without such a section."""
    prefix = f"{name}."
    values = {n: v for n, v in given.items() if n.startswith(prefix)}
    if not values:
        return None
    unknown = sorted(set(values) - {prefix + name for name in group._fields})
    if unknown:
        raise ParameterError(f"unknown: {', '.join(unknown)}")
    return build(group, values, prefix)
