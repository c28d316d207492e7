"""The graph as one process per node, as ``ros2 launch`` starts it."""

import json
import sys
from pathlib import Path
from time import sleep
from typing import Any, NamedTuple

from ament_index_python.packages import PackageNotFoundError, get_package_prefix

from furuta_bringup.graph.children import Children
from furuta_bringup.graph.graph_plan import Graph, tell_running
from furuta_model.accepted_parts import OWN_PARTS, accepted_parts
from furuta_model.parameters import ParameterError
from furuta_recordings.recorder_node import MakeRecorder, RecorderNode
from furuta_ros.middleware import ros_domain
from furuta_ros.one_graph import claim
from furuta_ros.process import StopSignal, bounded_end
from furuta_ros.spinning import fail, ros_context

# Time between two checks of the processes and of what to record [s].
CHECK_PERIOD = 0.02


class NodeProcess(NamedTuple):
    """A node to start in a process of its own."""

    package: str
    executable: str
    name: str
    namespace: str
    parameters: dict[str, Any]

    @property
    def parameter_arguments(self) -> list[str]:
        """ROS arguments that set the parameters.

        Text is quoted, so that ROS does not read a port named 1 as a number.
        """
        arguments = []
        own_parts = {OWN_PARTS: ",".join(accepted_parts())} if accepted_parts() else {}
        for name, value in (own_parts | self.parameters).items():
            arguments += ["-p", f"{name}:={json.dumps(value, ensure_ascii=False)}"]
        return arguments

    @property
    def command(self) -> list[str]:
        """The command that starts the process, as ``ros2 run`` would."""
        path = executable(self.package, self.executable)
        namespace = ["-r", f"__ns:={self.namespace}"] if self.namespace else []
        return [str(path), "--ros-args", *namespace, *self.parameter_arguments]


def node_processes(graph: Graph) -> list[NodeProcess]:
    """A process per node of the graph; the controlled system is the first."""
    return [
        NodeProcess(
            node.package, node.executable, node.name, graph.namespace, graph.parameters(node)
        )
        for node in graph.nodes
    ]


def executable(package: str, name: str) -> Path:
    """Where the install space keeps an executable, as ``ros2 run`` finds it."""
    try:
        directory = Path(get_package_prefix(package)) / "lib" / package
    except (PackageNotFoundError, ValueError):
        raise ParameterError(f"no package {package} is installed") from None
    path = directory / name
    if not path.is_file():
        known = ", ".join(sorted(file.name for file in directory.glob("*"))) or "none"
        raise ParameterError(f"package {package} has no executable {name}; it has {known}")
    return path


def run_processes(graph: Graph, stop: StopSignal, record: MakeRecorder | None = None) -> int:
    """Run a process per node until ``stop()`` or until one ends; returns the exit status.

    This process records, if ``record`` is given. The status is that of the first node that failed,
    with a line on standard error for each such node; it is 1 if the recording ended early.
    """
    claim(ros_domain(), graph.namespace or "/").close()  # its plant claims it for good
    if record is None:
        return _run(graph, stop)
    with ros_context(namespace=graph.namespace):
        recorder, status = record(), 1
        try:
            status = _run(graph, stop, recorder)
        finally:
            with bounded_end(status):
                recorder.destroy_node()
    return status


def _run(graph: Graph, stop: StopSignal, recorder: RecorderNode | None = None) -> int:
    started, collect = Children(), recorder.collect if recorder else lambda: None
    try:
        for node in node_processes(graph):
            started.start(node.name, node.command)
        tell_running(graph, "starting, each node says when it is ready")
        while not (stop() or started.any_has_ended()):
            collect()
            sleep(CHECK_PERIOD)
    finally:
        collect()  # the last messages of a node are lost when it ends
        started.end()
        if recorder is not None:
            recorder.close()
    failures = started.failures(stop())
    for name in failures:
        print(f"error: {started.describe_end(name)}", file=sys.stderr)
    unready = stop.status if stop() and not started.all_were_ready else 0
    unrecorded = 0
    if recorder is not None and recorder.failure is not None:
        unrecorded = fail(f"the recording is incomplete: {recorder.failure}")
    return next(iter(failures.values()), unready or unrecorded)
