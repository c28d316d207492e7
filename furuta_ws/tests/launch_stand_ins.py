"""Stand-ins for the modules of ``launch`` and ``launch_ros`` that a launch file uses.

They keep what a launch file gives them, so that a test can look at it without these packages.
"""

import sys
from collections.abc import Callable
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import pytest
from ament_index_python.packages import get_package_share_directory

from furuta_graph.processes import executable


class LaunchDescription(NamedTuple):
    """What ``ros2 launch`` would run."""

    entities: list[Any]


class DeclareLaunchArgument(NamedTuple):
    """A launch argument."""

    name: str
    default_value: str
    description: str


class OpaqueFunction(NamedTuple):
    """A function of the launch context that returns further entities."""

    function: Callable[[dict[str, str]], list[Any]]


class Shutdown(NamedTuple):
    """The end of the whole launch."""


class LaunchConfiguration(NamedTuple):
    """The value of a launch argument; the context is a dictionary of them."""

    name: str

    def perform(self, context: dict[str, str]) -> str:
        """The value, which is text."""
        return context[self.name]


class Node(NamedTuple):
    """A node to start, with the options of ``launch_ros.actions.Node`` that are in use."""

    package: str
    executable: str
    name: str
    namespace: str | None = None
    output: str = "log"
    ros_arguments: list[str] = []  # noqa: RUF012 - as the original
    respawn: bool = False
    respawn_delay: float | None = None
    on_exit: list[Any] | None = None
    parameters: list[dict[str, str]] = []  # noqa: RUF012 - as the original
    arguments: list[str] = []  # noqa: RUF012 - as the original

    @property
    def command(self) -> list[str]:
        """The command that ``ros2 launch`` starts."""
        remap = ["-r", f"__node:={self.name}"]
        remap += ["-r", f"__ns:={self.namespace}"] if self.namespace else []
        path = str(executable(self.package, self.executable))
        return [path, "--ros-args", *self.ros_arguments, *remap]


STAND_INS: dict[str, dict[str, Any]] = {
    "launch": {"LaunchContext": dict, "LaunchDescription": LaunchDescription},
    "launch.actions": {
        "DeclareLaunchArgument": DeclareLaunchArgument,
        "OpaqueFunction": OpaqueFunction,
        "Shutdown": Shutdown,
    },
    "launch.substitutions": {"LaunchConfiguration": LaunchConfiguration},
    "launch_ros": {},
    "launch_ros.actions": {"Node": Node},
}


def launch_arguments(monkeypatch: pytest.MonkeyPatch) -> list[DeclareLaunchArgument]:
    """The arguments of the launch file, as ``--show-args`` lists them."""
    return _entities(monkeypatch, "furuta_bringup", "furuta.launch.py")[:-1]


def launched_nodes(
    monkeypatch: pytest.MonkeyPatch,
    package: str = "furuta_bringup",
    file: str = "furuta.launch.py",
    **arguments: str,
) -> list[Node]:
    """The nodes that ``ros2 launch PACKAGE FILE name:=value`` starts."""
    *declared, function = _entities(monkeypatch, package, file)
    values = {argument.name: argument.default_value for argument in declared}
    assert arguments.keys() <= values.keys()
    nodes: list[Node] = function.function(values | arguments)
    return nodes


def _entities(monkeypatch: pytest.MonkeyPatch, package: str, name: str) -> list[Any]:
    """What the launch file describes, with the stand-ins in place of ``launch``."""
    for module, content in STAND_INS.items():
        monkeypatch.setitem(sys.modules, module, ModuleType(module))
        sys.modules[module].__dict__.update(content)
    file = Path(get_package_share_directory(package)) / "launch" / name
    specification = spec_from_file_location("furuta_launch", file)
    assert specification is not None
    assert specification.loader is not None
    launch_file = module_from_spec(specification)
    specification.loader.exec_module(launch_file)
    entities: list[Any] = launch_file.generate_launch_description().entities
    return entities
