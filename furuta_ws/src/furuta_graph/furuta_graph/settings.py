"""Parameters of all nodes, from parameter files and NAME=VALUE settings."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from furuta_analysis.simulation.closed_loop import Loop
from furuta_control.control import ControllerParameters
from furuta_control.estimation import EstimatorParameters
from furuta_friction.compensation import ObserverParameters
from furuta_hw.bridge.parameters import BridgeParameters
from furuta_model.parameters import Declared, ParameterError, build, declared
from furuta_sim.parameters import PlantNodeParameters

NODES: dict[str, type[NamedTuple]] = {
    "plant": PlantNodeParameters,
    "estimator": EstimatorParameters,
    "friction_observer": ObserverParameters,
    "controller": ControllerParameters,
    "hardware_bridge": BridgeParameters,
}
EVERY_NODE = "/**"
# Parameters that every ROS node has; they are not the loop's.
ROS_PARAMETERS = ("use_sim_time", "start_type_description_service")

# What is said of a node's parameters, by node and full parameter name.
Settings = dict[str, dict[str, Any]]


def load_settings(
    files: Iterable[Path], assignments: Iterable[str], base: Settings | None = None
) -> Settings:
    """Settings from ``base``, parameter files, assignments, later ones over earlier ones.

    Raises :class:`ParameterError` for anything that names no parameter or is not allowed.
    """
    settings: Settings = {node: dict((base or {}).get(node, {})) for node in NODES}
    for file in files:
        for node, given in read_file(file).items():
            settings[node] |= given
    return _assigned(settings, assignments)


def with_values(settings: Settings, values: Mapping[str, Any]) -> Settings:
    """The settings with further values by name, as checked as :func:`load_settings`'s."""
    copied = {node: dict(given) for node, given in settings.items()}
    return _assigned(copied, [f"{name}={value}" for name, value in values.items()])


def _assigned(settings: Settings, assignments: Iterable[str]) -> Settings:
    for assignment in assignments:
        name, separator, text = assignment.partition("=")
        if not separator:
            raise ParameterError(f"expected NAME=VALUE, given {assignment!r}")
        for node, each in parameters_named(name.strip()):
            settings[node][each.name] = _checked(each, _value(text, name))
    made = _made(settings)
    _check_sample_times(made)
    _check_seeing(made)
    return settings


def merge_settings(under: Settings, over: Settings) -> Settings:
    """Two settings in one, the second over the first."""
    return {node: under[node] | over[node] for node in NODES}


def _made(settings: Settings) -> dict[str, Any]:
    """Every node's parameters."""
    return {node: build(group, settings[node]) for node, group in NODES.items()}


def _check_sample_times(made: dict[str, Any]) -> None:
    times = {
        "plant": made["plant"].plant.sample_time,
        "estimator": made["estimator"].sample_time,
        "friction_observer": made["friction_observer"].sample_time,
        "controller": made["controller"].sample_time,
    }
    if len(set(times.values())) > 1:
        given = ", ".join(f"{node} {time:g} s" for node, time in times.items())
        raise ParameterError(f"sample_time must be the same for all nodes, given {given}")


def _check_seeing(made: dict[str, Any]) -> None:
    """Refuse a compensation that needs to see the friction with a filter that does not."""
    observer, estimator = made["friction_observer"], made["estimator"]
    if observer.chosen.needs_observed_friction and not estimator.chosen.observes_friction:
        raise ParameterError(
            f"compensation {observer.compensation} needs estimator.method=kalman, which tells "
            f"the friction; given {estimator.method}"
        )


def loop(settings: Settings) -> Loop:
    """The same parameters for the loop without ROS."""
    made = _made(settings)
    return Loop(
        made["plant"].plant, made["estimator"], made["friction_observer"], made["controller"]
    )


def read_file(file: Path) -> Settings:
    """Settings from a ROS parameter file."""
    try:
        content = yaml.safe_load(file.read_text())
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not a text file"
        raise ParameterError(f"cannot read parameter file {file}: {reason}") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f" in line {mark.line + 1}" if mark else ""
        problem = getattr(error, "problem", None) or "malformed"
        raise ParameterError(f"parameter file {file} is not YAML: {problem}{where}") from None
    if not isinstance(content, Mapping):
        raise ParameterError(f"parameter file {file} must map node names to ros__parameters")
    settings: Settings = {node: {} for node in NODES}
    for key, section in content.items():
        node = str(key).lstrip("/") if key != EVERY_NODE else EVERY_NODE
        if node != EVERY_NODE and node not in NODES:
            raise ParameterError(f"{file}: no node {key}; nodes are {', '.join(NODES)}")
        if not isinstance(section, Mapping) or not isinstance(
            section.get("ros__parameters"), Mapping
        ):
            raise ParameterError(f"{file}: {key} has no ros__parameters")
        for name, value in _flat(section["ros__parameters"]).items():
            if name in ROS_PARAMETERS:
                continue
            for target, each in _targets(node, name, file):
                settings[target][each.name] = _checked(each, value)
    return settings


def _targets(node: str, name: str, file: Path) -> list[tuple[str, Declared]]:
    """The parameter of a node or, for the wildcard, of each node that has it."""
    nodes = NODES if node == EVERY_NODE else {node: NODES[node]}
    found = [
        (target, each)
        for target, group in nodes.items()
        for each in declared(group)
        if each.name == name
    ]
    if not found:
        raise ParameterError(f"{file}: {node} has no parameter {name}{_similar(name)}")
    return found


def parameters_named(name: str) -> list[tuple[str, Declared]]:
    """Parameters that ``name`` means.

    ``node.parameter`` means one. Otherwise it is every parameter of that full name or of that
    last part: ``alpha0`` is the plant's true one and the observer's, ``alpha`` the true model's
    and the controller's nominal one.
    """
    node, _, rest = name.partition(".")
    if node in NODES:
        found = [(node, each) for each in declared(NODES[node]) if each.name == rest]
    else:
        found = [
            (target, each)
            for target, group in NODES.items()
            for each in declared(group)
            if name in (each.name, each.name.rpartition(".")[2])
        ]
    if not found:
        raise ParameterError(f"no parameter {name}{_similar(name)}")
    return found


def _similar(name: str) -> str:
    known = {
        part
        for group in NODES.values()
        for d in declared(group)
        for part in (d.name, d.name.rpartition(".")[2])
    }
    near = difflib.get_close_matches(name.rpartition(".")[2], sorted(known), n=3)
    return f"; did you mean {', '.join(near)}?" if near else ""


def _value(text: str, name: str) -> Any:
    try:
        return yaml.safe_load(text)
    except yaml.YAMLError:
        raise ParameterError(f"{name}: cannot read the value {text!r}") from None


def _checked(each: Declared, value: Any) -> Any:
    """The value as declared; 1e2 is a number too, though YAML 1.1 takes it for text."""
    if isinstance(value, str) and each.kind is float:
        value = _number(value)
    if isinstance(value, list) and each.kind is list:
        value = [_number(element) for element in value]
    return each.checked(value)


def _number(value: Any) -> Any:
    with suppress(ValueError, TypeError):
        return float(value)
    return value


def _flat(section: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for name, value in section.items():
        if isinstance(value, Mapping):
            flat |= _flat(value, f"{prefix}{name}.")
        else:
            flat[f"{prefix}{name}"] = value
    return flat
