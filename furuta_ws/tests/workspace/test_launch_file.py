"""The launch file starts the graph that the description describes."""

import re
from pathlib import Path
from typing import Any

import pytest
import yaml
from launch_stand_ins import Node, launch_arguments, launched_nodes
from sources import ROOT

from furuta_graph.settings.nodes import HARDWARE_BRIDGE, PLANT, graph_nodes
from furuta_model.parameters import ParameterError, declared

SEED = "plant: {ros__parameters: {seed: 1}}"


def options(node: Node, flag: str) -> list[str]:
    """The values that the ROS arguments of a node give with a flag."""
    flags, values = node.ros_arguments[::2], node.ros_arguments[1::2]
    assert set(flags) <= {"-p", "--log-level"}
    return [value for each, value in zip(flags, values, strict=True) if each == flag]


def parameters(node: Node) -> dict[str, Any]:
    """The parameters that the ROS arguments of a node give it."""
    pairs = (text.split(":=", 1) for text in options(node, "-p"))
    return {name: yaml.safe_load(re.sub(r"^(\d+)e", r"\1.0e", value)) for name, value in pairs}


@pytest.mark.parametrize(("port", "controlled"), [("", PLANT), ("/dev/null", HARDWARE_BRIDGE)])
def test_nodes_are_those_of_the_description(
    monkeypatch: pytest.MonkeyPatch, port: str, controlled: str
) -> None:
    """Names, packages, executables and every parameter; the controlled system ends the launch."""
    nodes = launched_nodes(monkeypatch, port=port)
    for node, about in zip(nodes, graph_nodes(controlled), strict=True):
        assert (node.name, node.package, node.executable) == (
            about.name,
            about.package,
            about.executable,
        )
        assert bool(node.on_exit) == about.controlled
        wanted = {each.name for each in declared(about.parameters)}
        assert set(parameters(node)) == wanted


def test_parameter_file_takes_precedence(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Over the rig, and the launch argument ``clock`` over the file."""
    file = tmp_path / "mine.yaml"
    file.write_text(
        "/**: {ros__parameters: {voltage_limit: 3.0}}\n"
        "plant: {ros__parameters: {clock: realtime, seed: 5}}\n"
    )
    nodes = launched_nodes(monkeypatch, rig="qube_servo_2", params_file=str(file), clock="lockstep")
    given = {node.name: parameters(node) for node in nodes}
    assert given["controller"]["voltage_limit"] == 3.0
    assert (given["plant"]["clock"], given["plant"]["seed"]) == ("lockstep", 5)


def test_namespace_and_nodes_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """All nodes are in the namespace; without one they are in that of the launch."""
    nodes = launched_nodes(monkeypatch, namespace="left", without="controller, friction_observer")
    assert [(node.name, node.namespace) for node in nodes] == [
        ("plant", "/left"),
        ("estimator", "/left"),
    ]
    assert {node.namespace for node in launched_nodes(monkeypatch)} == {None}


def test_every_argument_is_described(monkeypatch: pytest.MonkeyPatch) -> None:
    """``--show-args`` says what each is for, and the documentation names each."""
    page = (ROOT / "docs" / "graph.md").read_text()
    for argument in launch_arguments(monkeypatch):
        assert argument.description
        assert f"`{argument.name}`" in page


def test_compensation_takes_precedence(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Over the parameter file."""
    file = tmp_path / "mine.yaml"
    file.write_text("friction_observer: {ros__parameters: {compensation: coulomb, alpha0: 0.3}}")
    nodes = launched_nodes(monkeypatch, params_file=str(file), compensation="lugre")
    given = {node.name: parameters(node) for node in nodes}["friction_observer"]
    assert (given["compensation"], given["alpha0"]) == ("lugre", 0.3)


@pytest.mark.parametrize(
    ("arguments", "stamped"),
    [({"clock": "lockstep"}, True), ({"clock": "realtime"}, False), ({"port": "mock"}, False)],
)
def test_record_starts_a_recorder(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, arguments: dict[str, str], stamped: bool
) -> None:
    """In the same namespace, with the graph's parameters; nothing else changes."""
    monkeypatch.chdir(tmp_path)
    arguments |= {"namespace": "left", "compensation": "lugre"}
    *nodes, recorder = launched_nodes(monkeypatch, record="bags/mine", **arguments)
    assert nodes == launched_nodes(monkeypatch, **arguments)
    assert (recorder.package, recorder.executable) == ("furuta_recordings", "recorder")
    assert recorder.namespace == "/left"
    given = parameters(recorder)
    assert (given["directory"], given["stamped"]) == (str(tmp_path / "bags" / "mine"), stamped)
    kept = yaml.safe_load(given["graph_parameters"])
    assert kept["friction_observer"]["ros__parameters"]["compensation"] == "lugre"


@pytest.mark.parametrize("port", ["", "mock"])
def test_respawned_nodes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, port: str) -> None:
    """Not the controlled system, whose end is the end of the launch, nor the recorder."""
    bag = str(tmp_path / "bag")
    nodes = launched_nodes(monkeypatch, respawn="true", record=bag, port=port)
    respawned = {node.name for node in nodes if node.respawn}
    assert respawned == {"estimator", "friction_observer", "controller"}
    assert not any(node.respawn for node in launched_nodes(monkeypatch, record=bag, port=port))


def test_log_level_is_that_of_all_nodes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The recorder's too; without the argument it is ``info``."""
    for arguments, level in (({"log_level": "debug"}, "debug"), ({}, "info")):
        nodes = launched_nodes(monkeypatch, record=str(tmp_path / "bag"), **arguments)
        assert {tuple(options(node, "--log-level")) for node in nodes} == {(level,)}


@pytest.mark.parametrize(
    ("arguments", "content", "reason"),
    [
        ({}, "plant: {ros__parameters: {sample_time: 0.002}}", "sample_time must be the same"),
        ({"clock": "sundial"}, SEED, "clock must be one of"),
        (
            {"compensation": "lugre", "without": "friction_observer"},
            SEED,
            "compensation lugre needs the node friction_observer, which is left out",
        ),
        ({"view": "yes"}, SEED, "view must be one of true, false, given 'yes'"),
        ({"log_level": "loud"}, SEED, "log_level must be one of debug, .*, given 'loud'"),
        ({"record": "/dev/null"}, SEED, "/dev/null already exists; name another directory"),
        (
            {"port": "mock", "clock": "lockstep"},
            SEED,
            "a rig has its own clock: no clock with port",
        ),
    ],
)
def test_an_error_starts_no_node(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    arguments: dict[str, str],
    content: str,
    reason: str,
) -> None:
    """The launch fails with the reason before it has a node to start."""
    file = tmp_path / "file.yaml"
    file.write_text(content)
    with pytest.raises(ParameterError, match=reason):
        launched_nodes(monkeypatch, params_file=str(file), **arguments)


def test_view_adds_rviz_to_the_graph(monkeypatch: pytest.MonkeyPatch) -> None:
    """At the lengths of the rig, in the namespace; the same as display.launch.py starts."""
    given = {"rig": "qube_servo_2", "namespace": "left"}
    graph = launched_nodes(monkeypatch, **given)
    added = launched_nodes(monkeypatch, view="true", **given)[len(graph) :]
    display = "furuta_description", "display.launch.py"
    shown = launched_nodes(monkeypatch, *display, **given)
    assert [each.executable for each in shown] == ["robot_state_publisher", "rviz2"]
    for ours, theirs in zip(added, shown, strict=True):
        assert (ours.parameters, ours.arguments) == (theirs.parameters, theirs.arguments)
        assert ours.namespace == theirs.namespace == "/left"
    assert 'xyz="0.085 0 0"' in added[0].parameters[0]["robot_description"]


def test_a_recording_that_cannot_be_made_starts_no_node(monkeypatch: pytest.MonkeyPatch) -> None:
    """The launch is refused as a whole."""
    with pytest.raises(ParameterError, match="cannot make the bag /proc/x"):
        launched_nodes(monkeypatch, record="/proc/x")
