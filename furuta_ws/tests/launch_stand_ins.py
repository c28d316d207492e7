"""Stand-ins for the modules of ``launch`` and ``launch_ros`` that a launch file uses.

They keep what a launch file gives them, so that a test can look at it without these packages.
"""

import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
from ament_index_python.packages import get_package_share_directory

from furuta_graph.processes import executable


class Entity(SimpleNamespace):
    """Whatever is launched, with its arguments as attributes."""

    def __init__(self, *given: Any, **named: Any) -> None:
        super().__init__(given=given, **named)


class Argument(Entity):
    """``DeclareLaunchArgument``."""


class Configuration(Entity):
    """``LaunchConfiguration``: the value of a launch argument."""

    def perform(self, context: dict[str, str]) -> str:
        """The value, which is text."""
        return context[self.given[0]]


class Function(Entity):
    """``OpaqueFunction`` of the context, that returns further entities."""


class Node(Entity):
    """A node to start."""

    namespace, respawn, on_exit = None, False, None
    parameters, arguments = (), ()

    @property
    def command(self) -> list[str]:
        """The command that ``ros2 launch`` starts."""
        remap = ["-r", f"__node:={self.name}"]
        remap += ["-r", f"__ns:={self.namespace}"] if self.namespace else []
        path = str(executable(self.package, self.executable))
        return [path, "--ros-args", *self.ros_arguments, *remap]


STAND_INS: dict[str, dict[str, type]] = {
    "launch": {"LaunchContext": Entity, "LaunchDescription": Entity},
    "launch.actions": {
        "DeclareLaunchArgument": Argument, "OpaqueFunction": Function, "Shutdown": Entity
    },
    "launch.substitutions": {"LaunchConfiguration": Configuration},
    "launch_ros": {},
    "launch_ros.actions": {"Node": Node},
}  # fmt: skip


def launched_nodes(monkeypatch: pytest.MonkeyPatch, **arguments: str) -> list[Node]:
    """The nodes that ``ros2 launch furuta_bringup furuta.launch.py name:=value`` starts."""
    return _started(monkeypatch, "furuta_bringup", "furuta.launch.py", arguments)


def displayed_nodes(monkeypatch: pytest.MonkeyPatch, **arguments: str) -> list[Node]:
    """The nodes that ``ros2 launch furuta_description display.launch.py name:=value`` starts."""
    return _started(monkeypatch, "furuta_description", "display.launch.py", arguments)


def _started(
    monkeypatch: pytest.MonkeyPatch, package: str, file: str, arguments: dict[str, str]
) -> list[Node]:
    """What the launch file starts, with the stand-ins in place of ``launch``."""
    for name, classes in STAND_INS.items():
        module = ModuleType(name)
        vars(module).update(classes)
        monkeypatch.setitem(sys.modules, name, module)
    path = Path(get_package_share_directory(package)) / "launch" / file
    specification = spec_from_file_location("furuta_launch", path)
    assert specification is not None
    assert specification.loader is not None
    launch_file = module_from_spec(specification)
    specification.loader.exec_module(launch_file)
    (entities,) = launch_file.generate_launch_description().given
    declared = {e.given[0]: e.default_value for e in entities if isinstance(e, Argument)}
    assert arguments.keys() <= declared.keys()
    (function,) = (each for each in entities if isinstance(each, Function))
    nodes: list[Node] = function.function(declared | arguments)
    return nodes
