"""Reads and writes rig files: YAML with a section for each part of a :class:`Rig`.

The model is given in one of three forms: ``model`` (α, β, γ, δ), ``linear`` (the four identified
coefficients of (3)) or ``physical``. Values that a file does not give are those of the paper's rig.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import yaml

from furuta_hw.rigs.physical import PhysicalParameters, normalise
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.uncertainty import Uncertainty, uncertainty_from, uncertainty_section
from furuta_model.linear import from_linear
from furuta_model.parameters import About, ParameterError, build, declared, number_from_text, values
from furuta_model.pendulum import FurutaPendulum
from furuta_ros.yaml_files import read_yaml


class LinearCoefficients(NamedTuple):
    """The identified coefficients of the linear model (3)."""

    a23: Annotated[float, About("φ̈ per θ", "1/s²", high=0.0)] = -11.0
    a43: Annotated[float, About("θ̈ per θ", "1/s²", low=0.0)] = 33.0
    b21: Annotated[float, About("φ̈ per u", "rad/(V s²)", low=0.0)] = 45.0
    b41: Annotated[float, About("θ̈ per u", "rad/(V s²)", high=0.0)] = -29.0


# Sections of a rig file that hold text for the reader, and one that has its own reader.
TEXT_SECTIONS = ("name", "sources", "notes")
UNCERTAINTY = "uncertainty"
# Sections that are written even if they agree with the paper's rig.
ALWAYS_WRITTEN = ("model", "friction", "poles")
# The other forms of the model, and all names that a file may have.
_FORMS: dict[str, type[NamedTuple]] = {"linear": LinearCoefficients, "physical": PhysicalParameters}
_NAMES = {parameter.name for parameter in declared(Rig)} | {
    f"{form}.{name}" for form, group in _FORMS.items() for name in group._fields
}
_SECTIONS = {name.partition(".")[0] for name in _NAMES}


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
    forms = [form for form in ("model", *_FORMS) if form in content]
    if len(forms) > 1:
        raise ParameterError(f"give one of model, linear, physical, not {' and '.join(forms)}")
    given: dict[str, Any] = {}
    for section, parameters in content.items():
        if section in (*TEXT_SECTIONS, UNCERTAINTY):
            continue
        if not isinstance(parameters, Mapping):
            raise ParameterError(f"{section} must map names to values")
        if section not in _SECTIONS:
            raise ParameterError(f"unknown: {section}.{next(iter(parameters), '')}")
        given |= {f"{section}.{name}": _numbers(value) for name, value in parameters.items()}
    unknown = sorted(str(name) for name in given if name not in _NAMES)
    if unknown:
        raise ParameterError(f"unknown: {', '.join(unknown)}")
    return build(Rig, _with_model(given))


def _numbers(value: Any) -> Any:
    """Text that is a number as such, in lists too."""
    if isinstance(value, list):
        return [number_from_text(element) for element in value]
    return number_from_text(value)


def _with_model(given: dict[str, Any]) -> dict[str, Any]:
    """Convert ``linear`` or ``physical`` to ``model``; explicitly given values take precedence."""
    forms = {name.partition(".")[0] for name in given}
    if "linear" in forms:
        linear = build(LinearCoefficients, given, "linear.")
        if linear.b41 == 0.0:
            raise ParameterError("linear.b41 must be below 0")
        return _model(from_linear(*linear)) | given
    if "physical" in forms:
        physical = build(PhysicalParameters, given, "physical.")
        model, viscous, coulomb, torque_per_volt = normalise(physical)
        others = {"friction.viscous": viscous, "drive.torque_per_volt": torque_per_volt}
        if coulomb > 0.0:
            others["friction.alpha0"] = coulomb
        return _model(model) | others | given
    return given


def _model(model: FurutaPendulum) -> dict[str, Any]:
    return {f"model.{name}": value for name, value in model._asdict().items()}


def rig_file_text(
    rig: Rig, uncertainty: Uncertainty, name: str, comments: Iterable[str] = ()
) -> str:
    """The text of a rig file; ``comments`` come first, one a line."""
    head = "".join(f"# {' '.join(comment.split())}\n" for comment in comments)
    content: dict[str, Any] = {"name": name, **_sections(rig)}
    if uncertainty.names:
        content[UNCERTAINTY] = uncertainty_section(uncertainty)
    return head + yaml.safe_dump(
        content, sort_keys=False, allow_unicode=True, width=100, default_flow_style=None
    )


def _sections(rig: Rig) -> dict[str, dict[str, Any]]:
    """The values that differ from the paper's, by section; numbers with nine digits."""
    default, sections = values(Rig()), dict[str, dict[str, Any]]()
    for full, value in values(rig).items():
        section, _, name = full.partition(".")
        if section in ALWAYS_WRITTEN or value != default[full]:
            sections.setdefault(section, {})[name] = _rounded(value)
    return sections


def _rounded(value: Any) -> Any:
    if isinstance(value, list):
        return [_rounded(element) for element in value]
    return float(f"{value:.9g}") if isinstance(value, float) else value
