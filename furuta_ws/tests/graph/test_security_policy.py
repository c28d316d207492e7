"""The SROS2 policy against the nodes as they are: every topic and service, and no other one."""

import xml.etree.ElementTree as ET
from collections.abc import Callable

import pytest

from furuta.settings.nodes import NODES
from furuta_hw.rigs.known_rigs import config_directory
from furuta_ros.testing import Bench

POLICY = config_directory() / "security" / "policy.xml"
# Used only with use_sim_time, or offered by a plant in lock-step.
TIME = {"/clock"}
LISTS = ("publish", "subscribe", "reply", "request")


def profiles() -> dict[str, dict[str, set[str]]]:
    """Full names by node and by what the node may do with them."""
    found = {}
    for enclave in ET.parse(POLICY).getroot().iter("enclave"):
        (profile,) = enclave.iter("profile")
        name = profile.attrib["node"]
        assert enclave.attrib["path"] == f"/furuta/{name}"
        assert name not in found
        found[name] = {kind: allowed(profile, kind, name) for kind in LISTS}
    return found


def allowed(profile: ET.Element, kind: str, node: str) -> set[str]:
    lists = [each for each in profile if each.attrib.get(kind) == "ALLOW"]
    texts = [entry.text or "" for each in lists for entry in each]
    names = [text.replace("~", f"/{node}") for text in texts]
    assert len(set(names)) == len(names)
    return {name if name.startswith("/") else f"/{name}" for name in names}


def used(query: Callable[[str, str], list[tuple[str, list[str]]]], node: str) -> set[str]:
    """Full names that a query of the graph has for a node."""
    return {name for name, _ in query(node, "/")}


@pytest.mark.parametrize("name", NODES)
def test_a_node_may_do_what_it_does(bench: Bench, name: str) -> None:
    """Its publishers, subscriptions and services are those of its profile."""
    node = bench.add(NODES[name].load_class()())
    given = profiles()[name]
    queries = {
        "publish": node.get_publisher_names_and_types_by_node,
        "subscribe": node.get_subscriber_names_and_types_by_node,
        "reply": node.get_service_names_and_types_by_node,
        "request": node.get_client_names_and_types_by_node,
    }
    for kind, query in queries.items():
        # The middleware lists what a node has a little after the node has made it.
        bench.spin(lambda query=query, kind=kind: given[kind] - TIME <= used(query, name))
        assert used(query, name) - TIME == given[kind] - TIME, kind


def test_who_may_drive() -> None:
    """Only the controller publishes ``command``; only the operator calls services that act."""
    given = profiles()
    assert set(given) == {*NODES, "operator", "observer"}
    publishes = {name for name, lists in given.items() if "/command" in lists["publish"]}
    assert publishes == {"controller"}
    assert [name for name, lists in given.items() if lists["request"]] == ["operator"]
