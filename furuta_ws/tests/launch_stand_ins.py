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


class LaunchContext(NamedTuple):
    """The values of the launch arguments."""

    values: dict[str, str]


class LaunchDescription(NamedTuple):
    """What ``ros2 launch`` would run."""

    entities: list[Any]


class DeclareLaunchArgument(NamedTuple):
    """A launch argument."""

    name: str
    default_value: str
    description: str


class OpaqueFunction(NamedTuple):
    """A function of the context that returns further entities."""

    function: Callable[[LaunchContext], list[Any]]


class Shutdown(NamedTuple):
    """The end of the whole launch."""


class LaunchConfiguration(NamedTuple):
    """The value of a launch argument."""

    name: str

    def perform(self, context: LaunchContext) -> str:
        """The value, which is text."""
        return context.values[self.name]


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


STAND_INS: dict[str, tuple[type[Any], ...]] = {
    "launch": (LaunchContext, LaunchDescription),
    "launch.actions": (DeclareLaunchArgument, OpaqueFunction, Shutdown),
    "launch.substitutions": (LaunchConfiguration,),
    "launch_ros": (),
    "launch_ros.actions": (Node,),
}


def launched_nodes(monkeypatch: pytest.MonkeyPatch, **arguments: str) -> list[Node]:
    """The nodes that ``ros2 launch furuta_bringup furuta.launch.py name:=value`` starts."""
    return _started(_entities(monkeypatch), arguments)


def displayed_nodes(monkeypatch: pytest.MonkeyPatch, **arguments: str) -> list[Node]:
    """The nodes that ``ros2 launch furuta_description display.launch.py name:=value`` starts."""
    entities = _entities(monkeypatch, "furuta_description", "display.launch.py")
    return _started(entities, arguments)


def _started(entities: list[Any], arguments: dict[str, str]) -> list[Node]:
    declared = {e.name: e.default_value for e in entities if isinstance(e, DeclareLaunchArgument)}
    assert arguments.keys() <= declared.keys()
    (function,) = (each for each in entities if isinstance(each, OpaqueFunction))
    nodes: list[Node] = function.function(LaunchContext(declared | arguments))
    return nodes


def _entities(
    monkeypatch: pytest.MonkeyPatch,
    package: str = "furuta_bringup",
    file: str = "furuta.launch.py",
) -> list[Any]:
    """What the launch file describes, with the stand-ins in place of ``launch``."""
    for name, classes in STAND_INS.items():
        module = ModuleType(name)
        for each in classes:
            setattr(module, each.__name__, each)
        monkeypatch.setitem(sys.modules, name, module)
    entities: list[Any] = _launch_file(package, file).generate_launch_description().entities
    return entities


def _launch_file(package: str, name: str) -> ModuleType:
    file = Path(get_package_share_directory(package)) / "launch" / name
    specification = spec_from_file_location("furuta_launch", file)
    assert specification is not None
    assert specification.loader is not None
    module = module_from_spec(specification)
    specification.loader.exec_module(module)
    return module
