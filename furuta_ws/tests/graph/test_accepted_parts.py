"""Which names of code nodes, launch arguments, files and bags may use."""

import sys
from pathlib import Path
from typing import Any

import pytest
import yaml
from own_parts import EVIL
from std_msgs.msg import Float64

from furuta.settings.nodes import NODES
from furuta_bringup.graph.parameter_client import ParameterClient
from furuta_bringup.graph.services import ServiceError
from furuta_bringup.launching import launched_nodes
from furuta_model.parameters import ParameterError
from furuta_recordings.replay_node import message_class
from furuta_ros.spinning import ros_context
from furuta_ros.testing import Bench

# Node, parameter, and the default, of each parameter that can name code.
NAMING_CODE = [
    ("plant", "friction.law", "lugre"),
    ("estimator", "method", "kalman"),
    ("friction_observer", "compensation", "none"),
    ("controller", "mode", "balance"),
]


def write(file: Path, node: str, **parameters: Any) -> Path:
    file.write_text(yaml.safe_dump({node: {"ros__parameters": parameters}}))
    return file


@pytest.mark.parametrize(("name", "parameter", "default"), NAMING_CODE)
def test_a_request_imports_nothing(
    bench: Bench, evil: Path, name: str, parameter: str, default: str
) -> None:
    """It is refused with the reason, and the node goes on with what it had."""
    node = bench.add(NODES[name].load_class()([]))
    client = ParameterClient(bench.probe, bench.executor)
    for code in ("evil:f", "evil.py:f", "os:system", "venv.__main__:x"):
        with pytest.raises(ServiceError, match="is not accepted; name it when the process starts"):
            client.set_all(name, {parameter: code})
    with pytest.raises(ServiceError, match=r"own_parts is fixed at start$"):
        client.set_all(name, {"own_parts": "evil.py:f"})
    assert client.get(name, [parameter, "own_parts"]) == {parameter: default, "own_parts": ""}
    assert node.get_parameter(parameter).value == default
    assert not hasattr(sys, "loaded_evil")


@pytest.mark.parametrize("name", NODES)
def test_a_parameter_file_names_no_code(evil: Path, name: str) -> None:
    """Neither as a part nor as one that is accepted."""
    for parameter, code in (("own_parts", "evil.py:f"), ("own_parts", ["evil:f"])):
        file = write(evil / "theirs.yaml", name, **{parameter: code})
        with (
            ros_context(["--ros-args", "--params-file", str(file)]),
            pytest.raises(ParameterError, match="a parameter file cannot add 'evil"),
        ):
            NODES[name].load_class()([])
    assert not hasattr(sys, "loaded_evil")


def test_whoever_starts_a_node_names_its_parts(evil: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The node shows them, uses them while it runs, and takes no other."""
    (evil / "mine.py").write_text(EVIL)
    names = "controller:own_parts:=mine.py:f,evil.py:f"
    with Bench(["--ros-args", "-p", names, "-p", "mode:=mine.py:f"]) as bench:
        node = bench.add(NODES["controller"].load_class()([]))
        client = ParameterClient(bench.probe, bench.executor)
        assert client.get("controller", ["mode"]) == {"mode": "mine.py:f"}
        assert "mine.py:f,evil.py:f" in client.get("controller", ["own_parts"])["own_parts"]
        for mode in ("balance", "evil.py:f", "mine.py:f"):
            client.set_all("controller", {"mode": mode})
            assert node.parameters.mode == mode
        with pytest.raises(ServiceError, match="'evil:f' is not accepted"):
            client.set_all("controller", {"mode": "evil:f"})


def test_launch_names_parts_for_every_node(evil: Path) -> None:
    """A parameter file of a launch may use these, and no others."""
    for _, parameter, _ in NAMING_CODE:
        file = write(evil / "theirs.yaml", "/**", **{parameter: "evil:f"})
        with pytest.raises(ParameterError, match="'evil:f' is not accepted"):
            launched_nodes(params_file=str(file))
    assert not hasattr(sys, "loaded_evil")
    (evil / "launched.py").write_text(EVIL)
    file = write(evil / "mine.yaml", "controller", mode="launched.py:f")
    nodes = launched_nodes(params_file=str(file), own_parts="launched.py:f")
    for arguments in (node["ros_arguments"] for node in nodes):
        assert any("own_parts:=" in each and "launched.py:f" in each for each in arguments)


@pytest.mark.parametrize("name", ["evil/msg/f", "evil", "antigravity/msg/X", ".."])
def test_a_type_in_a_bag_imports_no_other_package(
    evil: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    """Only packages with ROS messages are imported, to replay them."""
    monkeypatch.syspath_prepend(evil)
    assert message_class(name) is None
    assert not hasattr(sys, "loaded_evil")
    assert "antigravity" not in sys.modules
    assert message_class("std_msgs/msg/Float64") is Float64
