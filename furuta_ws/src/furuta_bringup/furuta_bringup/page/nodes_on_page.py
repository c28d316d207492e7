"""Keeps what the page knows of the nodes' parameters the same as what the nodes have."""

import contextlib
import math
from collections.abc import Callable
from functools import partial
from typing import Any

from rcl_interfaces.msg import ParameterEvent
from rclpy.parameter import parameter_value_to_python

from furuta.settings.nodes import PLANT
from furuta_bringup.graph.services import ServiceError
from furuta_bringup.page.described import Described
from furuta_bringup.page.graph_link import GraphLink
from furuta_bringup.page.server import PageServer
from furuta_model.parameters import ParameterError
from furuta_ros.parameter_files import is_of_ros

# The order of the nodes; one with another name comes after these.
ORDER = ("friction_observer", "controller", "estimator", "plant", "hardware_bridge")
# The parameter that sets how far the plant runs: it changes all the time, and is not shown.
PACE = "run_until"


class NodesOnPage:
    """The nodes that run, and their parameters.

    ``changed`` is called after each change, ``later`` with what a job leaves to the page's thread.
    ``running`` names the nodes that were found, ``silent`` those of them that have not described
    their parameters, ``values`` holds the parameters of the others by node.
    """

    def __init__(
        self,
        server: PageServer,
        link: GraphLink,
        later: Callable[[Callable[[], None]], None],
        changed: Callable[[], None],
    ) -> None:
        self._server, self._link, self._later, self._changed = server, link, later, changed
        self._described: dict[str, dict[str, Described]] = {}
        self.running: list[str] = []
        self.values: dict[str, dict[str, Any]] = {}

    @property
    def silent(self) -> list[str]:
        """The nodes that have not answered yet, or whose answers were lost."""
        return [node for node in self.running if node not in self._described]

    def find(self) -> None:
        """Find nodes that come and go. Called in a job.

        A node that does not answer is asked again at the next call, and holds up no other one.
        """
        self.running = self._link.nodes()
        gone = [node for node in self._described if node not in self.running]
        if gone:
            self._later(partial(self._forget, gone))
        for node in self.silent:
            with contextlib.suppress(ServiceError):
                self._describe(node)

    def received(self, event: ParameterEvent) -> None:
        """Tell changed values; describe a node anew that has other parameters now."""
        node = event.node.rpartition("/")[2]
        known = self._described.get(node)
        if known is None:
            return
        declared = {new.name for new in event.new_parameters if not is_of_ros(new.name)}
        deleted = {old.name for old in event.deleted_parameters}
        if declared - set(known) or deleted & set(known):
            self._link.search.submit(("describe", node), partial(self._describe, node))
        changed = (*event.changed_parameters, *event.new_parameters)
        told = [each for each in changed if each.name in known]
        for each in told:
            with contextlib.suppress(RuntimeError):  # a type that ROS does not know
                self.values[node][each.name] = parameter_value_to_python(each.value)
        names = {f"{node}.{each.name}" for each in told} - {f"{PLANT}.{PACE}"}
        if names:
            new = {name: self.shown(name) for name in names}
            self._server.known["values"] |= new
            self._server.say(values=new)
            self._changed()

    def accepted(self, name: str, given: Any) -> Any:
        """A value for a parameter, by full name, of its type. Raises ParameterError for another."""
        node, _, own = name.partition(".")
        described = self._described.get(node, {}).get(own)
        if described is None:
            raise ParameterError(f"there is no parameter {name}")
        return described.accepted(given)

    def value(self, name: str) -> Any:
        """The value of a parameter by full name; None if there is none."""
        node, _, own = name.partition(".")
        return self.values.get(node, {}).get(own)

    def shown(self, name: str) -> Any:
        """The same as the page shows it."""
        return plain(self.value(name))

    def _describe(self, node: str) -> None:
        found = {each.name: each for each in self._link.described(node)}
        self._later(partial(self._add, node, found))

    def _add(self, node: str, found: dict[str, Described]) -> None:
        is_new = node not in self._described
        self._described[node] = found
        self.values[node] = {name: each.value for name, each in found.items()}
        self._tell({node} if is_new else set())

    def _forget(self, gone: list[str]) -> None:
        for node in gone:
            self._described.pop(node, None)
            self.values.pop(node, None)
        self._tell(set())

    def _tell(self, new: set[str]) -> None:
        """Tell all; values of ``new`` nodes are those before any scene."""
        by_rank = sorted(
            self._described, key=lambda n: ORDER.index(n) if n in ORDER else len(ORDER)
        )
        every = [each for node in by_rank for each in self._described[node].values()]
        about = [each.about() for each in every if each.name != PACE]
        names = [f"{node}.{name}" for node, own in self.values.items() for name in own]
        values = {name: self.shown(name) for name in names}
        base = {k: v for k, v in values.items() if k.partition(".")[0] in new}
        if PLANT in new:  # another graph, with a time of its own
            self._server.known.pop("zero", None)
        place = None if PLANT in new else self._server.known.get("place")
        self._server.tell(
            values=values,
            base=self._server.known.get("base", {}) | base,
            nodes=sorted(about, key=lambda each: (not each["in_sight"], each["in_sight"])),
            place=place,
        )
        self._changed()


def plain(value: Any) -> Any:
    """A value of a parameter as JSON knows it, which has no infinite number and no bytes."""
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    if value is None or isinstance(value, (bool, int, str)):
        return value
    return value.hex() if isinstance(value, bytes) else [plain(each) for each in value]
