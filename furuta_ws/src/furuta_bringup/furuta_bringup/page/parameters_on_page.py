"""Keeps the parameters on the page the same as those of the nodes, in both directions."""

import contextlib
from functools import partial
from typing import Any

from rcl_interfaces.msg import ParameterEvent
from rclpy.parameter import parameter_value_to_python

from furuta_bringup.graph.services import ServiceError
from furuta_bringup.page.graph_link import GraphLink
from furuta_bringup.page.parameter_panel import Control, NodeFolder
from furuta_ros.parameter_files import is_of_ros

# The parameters that come first on the page, if their nodes run, and what they are called there.
MAIN = {
    ("friction_observer", "compensation"): "compensation",
    ("friction_observer", "alpha0"): "believed alpha0",
    ("plant", "friction.alpha0"): "true alpha0",
    ("controller", "strength"): "strength",
    ("controller", "enabled"): "controller enabled",
}
# The order of the folders; a node with another name comes after these.
ORDER = ("friction_observer", "controller", "estimator", "plant", "hardware_bridge")


class ParametersOnPage:
    """Folders for the nodes that run, and the main parameters before them.

    ``running`` names the nodes that were found, ``silent`` those of them that have not described
    their parameters, and ``values`` holds the parameters of the others.
    """

    def __init__(self, gui: Any, link: GraphLink, main: Any, folders: Any) -> None:
        self._gui, self._link = gui, link
        self._main, self._place = main, folders
        self._folders: dict[str, NodeFolder] = {}
        self._first: dict[tuple[str, str], Control] = {}
        self.running: list[str] = []
        self.values: dict[str, dict[str, Any]] = {}

    def find_nodes(self) -> None:
        """Add and remove folders as nodes come and go. Called in a job.

        A node that does not answer is asked again at the next call, and holds up no other one.
        """
        running = self.running = self._link.nodes()
        for node in [name for name in self._folders if name not in running]:
            self._remove(node)
        for node in self.silent:
            with contextlib.suppress(ServiceError):
                self._add(node)

    @property
    def silent(self) -> list[str]:
        """The nodes that have not answered yet, or whose answers were lost."""
        return [node for node in self.running if node not in self._folders]

    def received(self, event: ParameterEvent) -> None:
        """Show changed values; describe a node anew that has other parameters now."""
        node = event.node.rpartition("/")[2]
        folder = self._folders.get(node)
        if folder is None:
            return
        known = folder.controls
        declared = {new.name for new in event.new_parameters if not is_of_ros(new.name)}
        deleted = {old.name for old in event.deleted_parameters}
        if declared - set(known) or deleted & set(known):
            self._link.search.submit(("describe", node), partial(self._replace, node))
        for changed in (*event.changed_parameters, *event.new_parameters):
            if changed.name in known:
                with contextlib.suppress(RuntimeError):  # a type that ROS does not know
                    self._show(node, changed.name, parameter_value_to_python(changed.value))

    def _enter(self, node: str, name: str, value: Any) -> None:
        """Set what the user has entered; a refusal is shown at its control."""
        work = partial(self._link.parameters.set_all, node, {name: value})
        self._link.requests.submit((node, name), work, partial(self._refuse, node, name))

    def _refuse(self, node: str, name: str, reason: str) -> None:
        for control in self._controls(node, name):
            control.refuse(reason)

    def _show(self, node: str, name: str, value: Any) -> None:
        self.values.get(node, {})[name] = value
        if self._link.requests.pending((node, name)):
            return  # the user has moved on meanwhile
        for control in self._controls(node, name):
            control.update(value)

    def _controls(self, node: str, name: str) -> list[Control]:
        folder = self._folders.get(node)
        controls = [folder.controls.get(name) if folder else None, self._first.get((node, name))]
        return [control for control in controls if control is not None]

    def _replace(self, node: str) -> None:
        self._remove(node)
        self._add(node)

    def _add(self, node: str) -> None:
        described = self._link.described(node)
        self.values[node] = {parameter.name: parameter.value for parameter in described}
        enter = partial(self._enter, node)
        for parameter in described:
            place = node, parameter.name
            if place in MAIN and place not in self._first:
                titled = parameter._replace(title=MAIN[place])
                rank = float(list(MAIN).index(place))
                with self._main:
                    self._first[place] = Control(self._gui, rank, titled, partial(enter, place[1]))
        order = float(ORDER.index(node) if node in ORDER else len(ORDER))
        with self._place:
            self._folders[node] = NodeFolder(self._gui, node, described, enter, order)

    def _remove(self, node: str) -> None:
        self._folders.pop(node).remove()
        self.values.pop(node)
