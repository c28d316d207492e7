"""What ``ros2 launch`` starts, and the launch files where ``launch`` is installed."""

import ast
import re
import shutil
import subprocess
import sys
from inspect import signature
from pathlib import Path
from runpy import run_path
from typing import Any

import pytest
import yaml
from sources import ROOT, SOURCES

from furuta.settings.nodes import HARDWARE_BRIDGE, PLANT, graph_nodes
from furuta_bringup.launching import launched_nodes
from furuta_model.parameters import ParameterError, declared

FILE = SOURCES / "furuta_bringup" / "launch" / "furuta.launch.py"
DISPLAY = SOURCES / "furuta_description" / "launch" / "display.launch.py"


def parameters(node: dict[str, Any]) -> dict[str, Any]:
    """The parameters that the ROS arguments of a node give it."""
    pairs = (text.split(":=", 1) for text in node["ros_arguments"] if ":=" in text)
    return {name: yaml.safe_load(re.sub(r"^(\d+)e", r"\1.0e", value)) for name, value in pairs}


def entities(file: Path) -> list[Any]:
    """What a launch file describes, by ``launch`` itself."""
    pytest.importorskip("launch_ros")
    described: list[Any] = run_path(str(file))["generate_launch_description"]().entities
    return described


@pytest.mark.parametrize(("port", "controlled"), [("", PLANT), ("/dev/null", HARDWARE_BRIDGE)])
def test_nodes_are_those_of_the_description(port: str, controlled: str) -> None:
    """Names, packages, executables and every parameter."""
    nodes = launched_nodes(port=port)
    for node, about in zip(nodes, graph_nodes(controlled), strict=True):
        named = tuple(node[key] for key in ("name", "package", "executable"))
        assert named == (about.name, about.package, about.executable)
        assert set(parameters(node)) == {each.name for each in declared(about.parameters)}


@pytest.mark.parametrize(
    ("arguments", "stamped"),
    [({"clock": "lockstep"}, True), ({"port": "mock"}, False)],
)
def test_record_starts_a_recorder(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, arguments: dict[str, str], stamped: bool
) -> None:
    """In the same namespace, with the graph's parameters; nothing else changes."""
    monkeypatch.chdir(tmp_path)
    arguments |= {"namespace": "left", "compensation": "lugre", "without": "estimator"}
    *nodes, recorder = launched_nodes(record="bags/mine", **arguments)
    assert nodes == launched_nodes(**arguments)
    assert len(nodes) == 3
    assert {node["namespace"] for node in (*nodes, recorder)} == {"/left"}
    given = parameters(recorder)
    assert (given["directory"], given["stamped"]) == (str(tmp_path / "bags" / "mine"), stamped)
    kept = yaml.safe_load(given["graph_parameters"])
    assert kept["friction_observer"]["ros__parameters"]["compensation"] == "lugre"


def test_a_view_follows_the_clock_of_its_graph() -> None:
    """Simulated time in lock-step only."""
    for clock, simulated in (("lockstep", True), ("realtime", False)):
        *_, publisher, rviz = launched_nodes(clock=clock, namespace="left", view="true")
        assert publisher["namespace"] == rviz["namespace"] == "/left"
        assert {n["parameters"][0]["use_sim_time"] for n in (publisher, rviz)} == {simulated}


def test_an_error_starts_no_node() -> None:
    """The launch fails with the reason before it has a node to start."""
    reason = "compensation lugre needs the node friction_observer, which is left out"
    with pytest.raises(ParameterError, match=reason):
        launched_nodes(compensation="lugre", without="friction_observer")


def test_arguments_of_the_launch_file() -> None:
    """They are those of ``launched_nodes``; the documentation names each."""
    (table,) = (
        node.value
        for node in ast.parse(FILE.read_text()).body
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Dict)
    )
    names = {key.value for key in table.keys if isinstance(key, ast.Constant)}
    assert names == set(signature(launched_nodes).parameters)
    page = (ROOT / "docs" / "graph.md").read_text()
    assert not [name for name in names if f"`{name}`" not in page]


@pytest.mark.parametrize(("file", "count"), [(FILE, 4), (DISPLAY, 2)])
def test_launch_file_with_launch_itself(file: Path, count: int) -> None:
    """It declares its arguments, each with a description, and makes its nodes."""
    *arguments, function = entities(file)
    assert all(argument.description for argument in arguments)
    launch = pytest.importorskip("launch")
    context = launch.LaunchContext()
    for argument in arguments:
        argument.visit(context)
    assert len(function.visit(context)) == count


@pytest.mark.parametrize("file", [FILE, DISPLAY])
def test_a_package_is_built_after_its_launch_file_has_run(tmp_path: Path, file: Path) -> None:
    """Python leaves its bytecode in a folder beside the file; setuptools installs no folder."""
    package = tmp_path / "package"
    shutil.copytree(file.parents[1], package, ignore=shutil.ignore_patterns("test"))
    (package / "launch" / "__pycache__").mkdir(exist_ok=True)
    install = [sys.executable, "setup.py", "-q", "install_data", "--install-dir", str(tmp_path)]
    subprocess.run(install, cwd=package, check=True, capture_output=True)
    assert len(list(tmp_path.glob("share/*/launch/*"))) == 1
