"""The graph as one process per node, as ``ros2 launch`` would start it."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import sleep

import rclpy
from ament_index_python.packages import PackageNotFoundError, get_package_prefix
from rclpy.signals import SignalHandlerOptions

from furuta_graph.settings import Settings
from furuta_model.parameters import ParameterError
from furuta_recordings.recorder_node import MakeRecorder

# Node name → package; the executable bears the node's name.
PACKAGES = {
    "plant": "furuta_sim",
    "estimator": "furuta_control",
    "friction_observer": "furuta_friction",
    "controller": "furuta_control",
}
# The same with the bridge to a rig in the plant's place.
HARDWARE = {"hardware_bridge": "furuta_hw"} | {
    node: package for node, package in PACKAGES.items() if node != "plant"
}
# Seconds between looks at the processes and at what is to be recorded, and that they get to end.
LOOK = 0.02
GRACE = 5.0


def executable(package: str, name: str) -> Path:
    """Where the install space keeps an executable, as ``ros2 run`` finds it."""
    try:
        directory = Path(get_package_prefix(package)) / "lib" / package
    except (PackageNotFoundError, ValueError):
        raise ParameterError(f"no package {package} is installed") from None
    path = directory / name
    if not path.is_file():
        known = ", ".join(sorted(each.name for each in directory.glob("*"))) or "none"
        raise ParameterError(f"package {package} has no executable {name}; it has {known}")
    return path


def arguments(values: dict[str, object]) -> list[str]:
    """ROS arguments that give a node these parameters."""
    given: list[str] = []
    for name, value in values.items():
        text = str(value).lower() if isinstance(value, bool) else str(value)
        if isinstance(value, tuple):
            text = str(list(value))
        given += ["-p", f"{name}:={text}"]
    return ["--ros-args", *given] if given else []


def run_processes(
    settings: Settings,
    stop: Callable[[], bool],
    packages: dict[str, str] = PACKAGES,
    record: MakeRecorder | None = None,
) -> int:
    """Run a process per node until ``stop()`` or until one ends; returns the exit status.

    This process itself records, if asked to.
    """
    with _collecting(record) as collect:
        children = {
            node: subprocess.Popen([executable(package, node), *arguments(settings[node])])
            for node, package in packages.items()
        }
        try:
            while not stop():
                ended = [node for node, child in children.items() if child.poll() is not None]
                if ended:
                    return max(children[node].returncode != 0 for node in ended)
                collect()
                sleep(LOOK)
            return 0
        finally:
            collect()  # what a node said is forgotten with it
            _end(list(children.values()))


@contextmanager
def _collecting(record: MakeRecorder | None) -> Iterator[Callable[[], None]]:
    """What is to be called now and then; the recording begins before and ends after."""
    if record is None:
        yield lambda: None
        return
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    try:
        recorder = record()
        try:
            yield recorder.collect
        finally:
            recorder.destroy_node()
    finally:
        rclpy.try_shutdown()


def _end(children: list[subprocess.Popen[bytes]]) -> None:
    for child in children:
        child.terminate()
    for child in children:
        try:
            child.wait(GRACE)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait()
