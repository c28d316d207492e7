"""Parameter files, as ROS tools and users write them, at the start of a node."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from furuta.settings.nodes import NODES
from furuta_bringup.graph.parameter_client import ParameterClient
from furuta_friction.friction_observer_node import FrictionObserverNode
from furuta_model.parameters import ParameterError, declared
from furuta_ros.spinning import ros_context
from furuta_ros.testing import Bench
from furuta_sim.plant_node import PlantNode


def start(node: Any, file: Path, namespace: str = "") -> Any:
    """Parameters of a node that is started with a parameter file."""
    with ros_context(["--ros-args", "--params-file", str(file)], namespace):
        made = node()
        parameters = made.parameters
        made.destroy_node()
    return parameters


def write(directory: Path, text: str) -> Path:
    file = directory / "mine.yaml"
    file.write_text(text)
    return file


def dump(name: str, parameters: dict[str, Any]) -> str:
    """What ``ros2 param dump`` prints: nested names under the full name of the node."""
    nested: dict[str, Any] = {}
    for key, value in parameters.items():
        *groups, last = key.split(".")
        inside = nested
        for group in groups:
            inside = inside.setdefault(group, {})
        inside[last] = list(value) if hasattr(value, "tolist") else value
    return yaml.dump({f"/{name}": {"ros__parameters": nested}}, default_flow_style=False)


def other_value(each: Any) -> Any:
    """An allowed value that is not the default."""
    if each.kind is bool:
        return not each.default
    if each.about.choices:
        return each.about.choices[-1]
    if each.kind is str:
        return "1"
    if each.kind is list:
        return [1.0, 2.0, 3.0, 4.5]
    return each.default * 0.99 if each.kind is float else each.default + 1


def changed_values(name: str) -> dict[str, Any]:
    every = declared(NODES[name].parameters)
    return {each.name: other_value(each) for each in every if not each.about.read_only}


@pytest.mark.parametrize("name", NODES)
def test_a_dump_loads_again(tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The output of ``ros2 param dump`` starts a node with the same changed parameters."""
    # No sample is taken, so that nothing has to be compiled for the changed plant.
    monkeypatch.setattr("furuta_sim.simulated_plant.for_types_of", lambda *_: None)
    node = NODES[name].load_class()
    with Bench() as bench:
        running = bench.add(node())
        client = ParameterClient(bench.probe, bench.executor)
        if changes := changed_values(name):
            client.set_all(name, changes)
        text = dump(name, client.get(name, client.names(name)))
        before = running.parameters
    assert start(node, write(tmp_path, text)) == before
    assert (before != NODES[name].parameters()) == bool(changes)


@pytest.mark.parametrize("word", ["off", "no", "true"])
def test_a_word_that_yaml_takes_for_a_boolean(word: str) -> None:
    """What is allowed is said, not which type ROS expects."""
    with (
        ros_context(["--ros-args", "-p", f"compensation:={word}"]),
        pytest.raises(ParameterError, match=r"^compensation must be .*none, coulomb"),
    ):
        FrictionObserverNode()


def test_a_section_for_several_nodes(tmp_path: Path, capfd: Any) -> None:
    """A name that the node does not have is reported once and ignored; the others apply.

    In the node's own section it is an error.
    """
    content = "{kalman.alpha: 0.03, kalman: {beta: 0.02}, alpha0: 0.3, use_sim_time: false}"
    file = write(tmp_path, f"/**: {{ros__parameters: {content}}}")
    assert start(FrictionObserverNode, file).observer.friction.alpha0 == 0.3
    (warning,) = [line for line in capfd.readouterr().err.splitlines() if "WARN" in line]
    assert "friction_observer has no parameter kalman.alpha, kalman.beta; ignored" in warning
    assert f"the section /** of {file}" in warning
    file = write(tmp_path, f"friction_observer: {{ros__parameters: {content}}}")
    with pytest.raises(ParameterError, match=r"friction_observer has no parameter kalman\.alpha"):
        start(FrictionObserverNode, file)


def test_a_section_without_the_namespace(tmp_path: Path) -> None:
    """ROS would drop it without a word; the node is refused with the name that it needs."""
    file = write(tmp_path, "plant: {ros__parameters: {seed: 5}}")
    assert start(PlantNode, file).plant.seed == 5
    with pytest.raises(ParameterError, match=r"section plant is for /plant, .* /left/plant or"):
        start(PlantNode, file, "/left")


@pytest.mark.parametrize(
    "text",
    [
        "/left/plant: {ros__parameters: {seed: 5}}",
        "left: {plant: {ros__parameters: {seed: 5}}}",
        "/**/plant: {ros__parameters: {seed: 5}}",
        "plant: {ros__parameters: {seed: 4}}\n/left/plant: {ros__parameters: {seed: 5}}",
    ],
)
def test_sections_with_the_namespace(tmp_path: Path, capfd: Any, text: str) -> None:
    """All ways to name a node in a namespace; a file may name the node in the root as well."""
    assert start(PlantNode, write(tmp_path, text), "/left").plant.seed == 5
    assert "WARN" not in capfd.readouterr().err


def test_a_file_for_other_nodes(tmp_path: Path, capfd: Any) -> None:
    """A file without a section for the node is reported: the name may be misspelt."""
    file = write(tmp_path, "plent: {ros__parameters: {seed: 5}}")
    assert start(PlantNode, file).plant.seed == 0
    assert f"{file} has no section for /plant, only for plent" in capfd.readouterr().err
