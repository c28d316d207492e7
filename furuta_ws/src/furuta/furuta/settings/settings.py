"""Settings: parameters of all nodes, from parameter files and NAME=VALUE assignments."""

import logging
from collections.abc import Collection, Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from furuta.settings.nodes import NODES, check_graph
from furuta.settings.parameter_names import (
    EVERY_NODE,
    parameters_in,
    parameters_named,
)
from furuta_control.control import POLE_PLACEMENT
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.rig_file import is_rig_file, rig_from_content
from furuta_model.linear import DesiredPoles
from furuta_model.parameters import ParameterError, build, values
from furuta_ros.parameter_files import Section, is_of_ros, sections
from furuta_ros.yaml_files import parse_yaml, read_yaml
from furuta_sim.simulation.closed_loop import PARTS, Loop

# Most unknown names of a section that are reported; each is compared with all known ones.
MOST_REPORTED = 10
_LOG = logging.getLogger(__name__)


class Settings(dict[str, dict[str, Any]]):
    """Values by node and full parameter name; all others are the defaults.

    ``implied`` has the full names of values that nobody has chosen: defaults that a parameter file
    repeats.
    """

    implied: frozenset[str] = frozenset()

    def chosen(self) -> frozenset[str]:
        """Full names of all values that are not implied."""
        return frozenset(self._names()) - self.implied

    def _names(self) -> Iterator[str]:
        return (f"{node}.{name}" for node, values in self.items() for name in values)


def default_settings() -> Settings:
    """Settings that leave every parameter at its default."""
    return Settings({node: {} for node in NODES})


def rig_settings(rig: Rig) -> Settings:
    """Parameters that the rig determines: model, friction, sensors, drive, sample time and limits.

    Viscous friction, which contains back-EMF, is part of the model of estimator, observer and pole
    placement. The friction observer therefore compensates the rest of the friction.
    """
    model, sensors = values(rig.model, "model."), values(rig.sensors, "sensors.")
    nominal = model | {"model_viscous": rig.friction.viscous}
    observing = nominal | values(rig.drive_dynamics.late, "drive.")
    time = {"sample_time": rig.line.sample_time}
    settings = default_settings()
    settings["plant"] = model | sensors | values(rig.friction, "friction.") | time
    settings["plant"] |= _plant_parts(rig)
    settings["estimator"] = observing | sensors | time | values(rig.kalman)
    settings["friction_observer"] = values(rig.friction._replace(viscous=0.0)) | observing | time
    settings["controller"] = nominal | time | values(rig.poles) | _limits(rig)
    return settings


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
    without: Collection[str] = (),
) -> Settings:
    """Settings from ``base``, parameter files and assignments; later ones take precedence.

    ``namespace`` is that of the graph, such as ``/left``. A node of the user's own may take the
    place of one in ``without``: what a file has for it beside our parameters is ignored.

    Raises:
        ParameterError: A name is unknown, a value is not allowed, or nodes do not fit together.
    """
    settings = collect_settings(files, assignments, base, namespace, without)
    check_graph(parameters_of(settings))
    return settings


def collect_settings(
    files: Iterable[Path],
    assignments: Iterable[str],
    base: Settings | None = None,
    namespace: str = "",
    without: Collection[str] = (),
) -> Settings:
    """Like :func:`load_settings`, without the checks of several parameters together."""
    settings = base or default_settings()
    for file in files:
        settings = merge_settings(settings, read_file(file, namespace, without))
    return settings_with(settings, map(parse_assignment, assignments))


def parse_assignment(text: str) -> tuple[str, Any]:
    """Name and value of NAME=VALUE."""
    name, separator, value = text.partition("=")
    if not separator:
        raise ParameterError(f"expected NAME=VALUE, given {text!r}")
    return name.strip(), _value(value, name)


def law_and_feedback(
    law: str | None, feedback: tuple[float, float, float, float] | None
) -> dict[str, str]:
    """The assignments that the options ``--law`` and ``--feedback`` stand for, by option."""
    assignments = {}
    if law:
        assignments["--law"] = f"plant.friction.law={law}"
    if feedback:
        assignments["--feedback"] = f"controller.gain={[-gain for gain in feedback]}"
    return assignments


def require_agreement(assignments: Iterable[str], options: Mapping[str, str]) -> None:
    """Reject an assignment to what an option of a verb sets to another value.

    ``options`` are the assignments that they stand for, by the name of the option.
    """
    assigned: dict[str, tuple[Any, str]] = {}
    for assignment in assignments:
        name, value = parse_assignment(assignment)
        assigned |= dict.fromkeys(_full_names(name), (value, assignment))
    for option, meant in options.items():
        name, value = parse_assignment(meant)
        for full_name in _full_names(name):
            other, assignment = assigned.get(full_name, (value, ""))
            if other != value:
                raise ParameterError(
                    f"{option} sets {full_name} and so does --set {assignment}: leave out one"
                )


def _full_names(name: str) -> list[str]:
    return [f"{match.node}.{match.parameter.name}" for match in parameters_named(name)]


def settings_with(settings: Settings, given: Iterable[tuple[str, Any]]) -> Settings:
    """Settings with further values, each by a name as on the command line."""
    added = default_settings()
    for name, value in given:
        for match in parameters_named(name):
            added[match.node][match.parameter.name] = match.parameter.parsed(value)
    _require_one_gain(added["controller"])
    return merge_settings(settings, added)


def _require_one_gain(assigned: Mapping[str, Any]) -> None:
    poles = [name for name in DesiredPoles._fields if name in assigned]
    if poles and assigned.get("gain", POLE_PLACEMENT) != POLE_PLACEMENT:
        raise ParameterError(
            f"controller.gain takes the place of the poles: leave out {', '.join(poles)}, or it"
        )


def merge_settings(under: Settings, over: Settings) -> Settings:
    """Two settings in one; the second takes precedence."""
    merged = Settings({node: under[node] | over[node] for node in NODES})
    merged.implied = (under.implied - over.chosen()) | over.implied
    return merged


def parameters_of(settings: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Every node's parameters."""
    return {name: build(node.parameters, settings[name]) for name, node in NODES.items()}


def loop(settings: Mapping[str, Mapping[str, Any]]) -> Loop:
    """The same parameters for the loop without ROS."""
    return _loop(parameters_of(settings))


def loop_settings(of: Loop) -> Settings:
    """Settings that describe a loop: the inverse of :func:`loop`."""
    settings = default_settings()
    for node, group in zip(PARTS, of, strict=True):
        settings[node] = values(group)
    return settings


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


def read_file(file: Path, namespace: str = "", without: Collection[str] = ()) -> Settings:
    """Settings of the graph in a namespace from a ROS parameter file, or from a rig file."""
    content = read_yaml(file, "parameter file")
    if isinstance(content, Mapping) and is_rig_file(content):
        rig, _ = rig_from_content(content, file)
        return rig_settings(rig)
    settings = default_settings()
    for section in _applied(list(sections(content, file)), file, namespace):
        node = _node_name(section.key, file)
        _set_all(settings, node, section.parameters, file, is_replaced=node in without)
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


def _set_all(
    settings: Settings, node: str, values: Mapping[str, Any], file: Path, is_replaced: bool
) -> None:
    """Set the values of a section; raises ParameterError with its unknown names.

    If the node is replaced by another one, they are that one's parameters.
    """
    unknown = []
    for name, value in values.items():
        if is_of_ros(name):
            if name == "use_sim_time" and value:
                warn_once(f"{file}: use_sim_time is ignored, no node of the graph needs it")
            continue
        try:
            matches = parameters_in(node, name)
        except ParameterError as error:
            if is_replaced:
                continue
            unknown.append(str(error))
            if len(unknown) == MOST_REPORTED:
                break
            continue
        for match in matches:
            parsed = match.parameter.parsed(value)
            settings[match.node][match.parameter.name] = parsed
            if parsed == match.parameter.default:  # as all are in a file with every parameter
                settings.implied |= {f"{match.node}.{match.parameter.name}"}
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
