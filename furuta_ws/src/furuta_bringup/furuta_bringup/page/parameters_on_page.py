"""Keeps the parameters on the page the same as those of the nodes, in both directions."""

import contextlib
from collections.abc import Callable
from functools import partial
from typing import Any

from rcl_interfaces.msg import ParameterEvent
from rclpy.parameter import parameter_value_to_python

from furuta_bringup.graph.services import ServiceError
from furuta_bringup.page.graph_link import GraphLink
from furuta_bringup.page.guided_scenes import (
    COMPENSATIONS,
    IN_SIGHT,
    entered_values,
    shown_compensation,
)
from furuta_bringup.page.parameter_panel import Control, Described, NodeFolder
from furuta_ros.parameter_files import is_of_ros

# The parameters that tell which compensation is in force.
COMPENSATION, SUPER_TWISTING = (
    ("friction_observer", "compensation"),
    ("controller", "super_twisting"),
)
# The order of the folders; a node with another name comes after these.
ORDER = ("friction_observer", "controller", "estimator", "plant", "hardware_bridge")


class ParametersOnPage:
    """Folders for the nodes that run, and the parameters in sight before them.

    ``changed`` is called with the names of parameters that a node has changed. ``running`` names
    the nodes that were found, ``silent`` those of them that have not described their parameters,
    and ``values`` holds the parameters of the others.
    """

    def __init__(
        self,
        gui: Any,
        link: GraphLink,
        main: Any,
        folders: Any,
        changed: Callable[[set[str]], None],
    ) -> None:
        self._gui, self._link, self._changed = gui, link, changed
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
        changed = [*event.changed_parameters, *event.new_parameters]
        for each in changed:
            if each.name in known:
                with contextlib.suppress(RuntimeError):  # a type that ROS does not know
                    self._show(node, each.name, parameter_value_to_python(each.value))
        self._changed({each.name for each in changed})

    def _enter(self, node: str, name: str, value: Any) -> None:
        self._submit(node, name, lambda: {f"{node}.{name}": value})

    def _enter_in_sight(self, node: str, name: str, value: Any) -> None:
        self._submit(node, name, lambda: entered_values(node, name, value, self.values))

    def _submit(self, node: str, name: str, entered: Callable[[], dict[str, Any]]) -> None:
        """Set what the user has entered; a refusal is shown at its control."""
        refuse = partial(self._refuse, node, name)
        self._link.requests.submit((node, name), lambda: self._link.set_values(entered()), refuse)

    def _refuse(self, node: str, name: str, reason: str) -> None:
        for control in self._controls(node, name):
            control.refuse(reason)

    def _show(self, node: str, name: str, value: Any) -> None:
        self.values.get(node, {})[name] = value
        if not self._link.requests.pending((node, name)):  # otherwise the user has moved on
            for control in self._controls(node, name):
                control.update(value)
        first = self._first.get(COMPENSATION)
        told = (node, name) in (COMPENSATION, SUPER_TWISTING)
        if told and first is not None and not self._link.requests.pending(COMPENSATION):
            first.update(shown_compensation(self.values))

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
            if ".".join(place) in IN_SIGHT and place not in self._first:
                with self._main:
                    self._first[place] = self._in_sight(parameter)
        order = float(ORDER.index(node) if node in ORDER else len(ORDER))
        with self._place:
            self._folders[node] = NodeFolder(self._gui, node, described, enter, order)

    def _in_sight(self, parameter: Described) -> Control:
        place = parameter.node, parameter.name
        titled = parameter._replace(title=IN_SIGHT[".".join(place)])
        if place == COMPENSATION:
            shown = shown_compensation(self.values)
            titled = titled._replace(value=shown, words=COMPENSATIONS)
        rank = float(list(IN_SIGHT).index(".".join(place)))
        return Control(self._gui, rank, titled, partial(self._enter_in_sight, *place))

    def _remove(self, node: str) -> None:
        self._folders.pop(node).remove()
        self.values.pop(node)
