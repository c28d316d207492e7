"""Settings: parameters of all nodes, from parameter files and NAME=VALUE assignments."""

import logging
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from furuta.settings.nodes import NODES, check_graph
from furuta.settings.parameter_names import EVERY_NODE, parameters_in, parameters_named
from furuta.settings.recommended import is_recommended, recommended_values
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.rig_file import is_rig_file, rig_from_content
from furuta_model.parameters import ParameterError, build, values
from furuta_ros.parameter_files import Section, is_of_ros, sections
from furuta_ros.yaml_files import parse_yaml, read_yaml
from furuta_sim.simulation.closed_loop import PARTS, Loop

# Most unknown names of a section that are reported; each is compared with all known ones.
MOST_REPORTED = 10
_LOG = logging.getLogger(__name__)

# Values that differ from the defaults, by node and full parameter name.
Settings = dict[str, dict[str, Any]]


def default_settings() -> Settings:
    """Settings that leave every parameter at its default."""
    return {node: {} for node in NODES}


def rig_settings(rig: Rig) -> Settings:
    """Parameters that the rig determines: model, friction, sensors, sample time and limits.

    Viscous friction, which contains back-EMF, is part of the model of estimator and pole placement.
    The friction observer therefore compensates the rest of the friction.
    """
    model, sensors = values(rig.model, "model."), values(rig.sensors, "sensors.")
    nominal = model | {"model_viscous": rig.friction.viscous}
    time = {"sample_time": rig.line.sample_time}
    return default_settings() | {
        "plant": model | sensors | values(rig.friction, "friction.") | time | _plant_parts(rig),
        "estimator": nominal | sensors | time | values(rig.kalman),
        "friction_observer": values(rig.friction._replace(viscous=0.0)) | time,
        "controller": nominal | time | values(rig.poles) | _limits(rig),
    }


def _plant_parts(rig: Rig) -> dict[str, Any]:
    """What else acts on the simulated plant."""
    return {
        "actuator.voltage_range": rig.drive.range,
        "actuator.bits": rig.drive.bits,
        **values(rig.drive_dynamics, "drive."),
        **values(rig.coupling, "coupling."),
        "sensor_faults.speed_bandwidth": rig.speed.bandwidth * (rig.speed.sensor == "encoder"),
        **values(rig.pendulum_friction, "pendulum_friction."),
        **values(rig.waves, "waves."),
        **values(rig.tilt, "tilt."),
    }


def _limits(rig: Rig) -> dict[str, Any]:
    return {
        "voltage_limit": rig.limits.voltage,
        "arm_angle_limit": rig.limits.arm_angle,
        "arm_speed_limit": rig.limits.arm_speed,
    }


def load_settings(
    files: Iterable[Path],
    assignments: Iterable[str],
    base: Settings | None = None,
    namespace: str = "",
) -> Settings:
    """Settings from ``base``, parameter files and assignments; later ones take precedence.

    ``namespace`` is that of the graph, such as ``/left``.

    Raises:
        ParameterError: A name is unknown, a value is not allowed, or nodes do not fit together.
    """
    settings = collect_settings(files, assignments, base, namespace)
    check_graph(parameters_of(settings))
    return settings


def collect_settings(
    files: Iterable[Path],
    assignments: Iterable[str],
    base: Settings | None = None,
    namespace: str = "",
) -> Settings:
    """Like :func:`load_settings`, without the checks of several parameters together."""
    settings = base or default_settings()
    for file in files:
        settings = merge_settings(settings, read_file(file, namespace))
    return settings_with(settings, map(parse_assignment, assignments))


def parse_assignment(text: str) -> tuple[str, Any]:
    """Name and value of NAME=VALUE."""
    name, separator, value = text.partition("=")
    if not separator:
        raise ParameterError(f"expected NAME=VALUE, given {text!r}")
    return name.strip(), _value(value, name)


def settings_with(settings: Settings, given: Iterable[tuple[str, Any]]) -> Settings:
    """Settings with further values, each by a name as on the command line."""
    changed = merge_settings(settings, default_settings())
    given = list(given)
    asked = [number for number, item in enumerate(given) if is_recommended(*item)]
    last = asked[-1] if asked else -1
    # The recommended setting follows from all others, and those that come after it prevail.
    for name, value in [item for item in given if not is_recommended(*item)]:
        for match in parameters_named(name):
            changed[match.node][match.parameter.name] = match.parameter.parsed(value)
    if asked:
        chosen = recommended_values(_loop(parameters_of(changed)))
        changed = settings_with(changed, [*chosen.items(), *given[last + 1 :]])
    return changed


def merge_settings(under: Settings, over: Settings) -> Settings:
    """Two settings in one; the second takes precedence."""
    return {node: under[node] | over[node] for node in NODES}


def parameters_of(settings: Settings) -> dict[str, Any]:
    """Every node's parameters."""
    return {name: build(node.parameters, settings[name]) for name, node in NODES.items()}


def loop(settings: Settings) -> Loop:
    """The same parameters for the loop without ROS."""
    return _loop(parameters_of(settings))


def loop_settings(of: Loop) -> Settings:
    """Settings that describe a loop: the inverse of :func:`loop`."""
    nodes = zip(PARTS, of, strict=True)
    return default_settings() | {node: values(group) for node, group in nodes}


def loop_with(settings: Settings, values: Mapping[str, Any]) -> Loop:
    """The loop with further values by name, checked as :func:`load_settings` does.

    A value can also be text as in an assignment.
    """
    plain = (
        (name, _value(value, name) if isinstance(value, str) else value)
        for name, value in values.items()
    )
    made = parameters_of(settings_with(settings, plain))
    check_graph(made)
    return _loop(made)


def _loop(made: Mapping[str, Any]) -> Loop:
    plant, estimator, observer, controller = (made[node] for node in PARTS)
    return Loop(plant.plant, estimator, observer.observer, controller)


def read_file(file: Path, namespace: str = "") -> Settings:
    """Settings of the graph in a namespace from a ROS parameter file, or from a rig file."""
    content = read_yaml(file, "parameter file")
    if isinstance(content, Mapping) and is_rig_file(content):
        rig, _ = rig_from_content(content, file)
        return rig_settings(rig)
    settings = default_settings()
    for section in _applied(list(sections(content, file)), file, namespace):
        _set_all(settings, _node_name(section.key, file), section.parameters, file)
    return settings


def _applied(given: list[Section], file: Path, namespace: str) -> list[Section]:
    """The sections for a graph in a namespace, as ROS applies them, and those without one.

    A graph without a namespace takes those of the only namespace that the file names.
    """
    named = {section.namespace for section in given if "*" not in section.namespace} - {""}
    if not namespace and len(named) > 1:
        raise ParameterError(
            f"{file} is for several namespaces, {', '.join(sorted(named))}: start the graph with "
            "--namespace, or leave the sections of one only"
        )
    own = [s for s in given if not namespace or not s.namespace or s.is_in(namespace)]
    if given and not own:
        raise ParameterError(
            f"{file} has no section for the namespace {namespace}, only for "
            f"{', '.join(section.key for section in given)}"
        )
    return own


def _node_name(key: str, file: Path) -> str:
    """The node that a section of a file is for."""
    last = key.rpartition("/")[2]
    name = EVERY_NODE if last in ("*", "**") else last
    if name != EVERY_NODE and name not in NODES:
        raise ParameterError(f"{file}: no node {key}; nodes are {', '.join(NODES)}")
    return name


def _set_all(settings: Settings, node: str, values: Mapping[str, Any], file: Path) -> None:
    """Set the values of a section; raises ParameterError with its unknown names."""
    unknown = []
    for name, value in values.items():
        if is_of_ros(name):
            if name == "use_sim_time" and value:
                warn_once(f"{file}: use_sim_time is ignored, no node of the graph needs it")
            continue
        try:
            matches = parameters_in(node, name)
        except ParameterError as error:
            unknown.append(str(error))
            if len(unknown) == MOST_REPORTED:
                break
            continue
        for match in matches:
            settings[match.node][match.parameter.name] = match.parameter.parsed(value)
    if unknown:
        raise ParameterError(f"{file}: {'; '.join(unknown)}")


@cache
def warn_once(message: str) -> None:
    """Log a warning; the same one only once, since studies read the same settings many times."""
    _LOG.warning(message)


def _value(text: str, name: str) -> Any:
    try:
        return parse_yaml(text, name)
    except ParameterError:
        raise ParameterError(f"{name}: cannot read the value {text!r}") from None
