"""Which machines a process reaches: this one, unless the user chooses the network."""

import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from furuta_bringup.graph.processes import executable
from furuta_ros.middleware import RANGE, describe_discovery, reaches_network, restrict_discovery

VARIABLES = (RANGE, "ROS_STATIC_PEERS", "ROS_DISCOVERY_SERVER", "ROS_LOCALHOST_ONLY")
# Of the DDS specification: the port on which a participant receives multicast discovery.
MULTICAST_PORT = 7400 + 250 * int(os.environ["ROS_DOMAIN_ID"])


@pytest.fixture
def choose(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Make the user's choice: these variables and no other ones."""

    def make(**given: str) -> None:
        for name in VARIABLES:
            monkeypatch.delenv(name, raising=False)
        for name, value in given.items():
            monkeypatch.setenv(name, value)

    return make


@pytest.mark.parametrize(
    ("given", "chosen", "network"),
    [
        ({}, "LOCALHOST", False),
        ({RANGE: "SUBNET"}, "SUBNET", True),
        ({"ROS_DISCOVERY_SERVER": "192.0.2.7:11811"}, None, True),
        ({RANGE: "SUBNET", "ROS_LOCALHOST_ONLY": "1"}, "SUBNET", False),
    ],
)
def test_choices(choose: Any, given: dict[str, str], chosen: str | None, network: bool) -> None:
    """Without a choice this machine only; the choice of the user is left as it is."""
    choose(**given)
    restrict_discovery()
    assert os.environ.get(RANGE) == chosen
    assert reaches_network() == network
    assert describe_discovery().startswith("the network" if network else "this machine only")


def udp_ports(pid: int) -> Iterator[int]:
    """The UDP ports of a process."""
    links = (os.readlink(each) for each in Path(f"/proc/{pid}/fd").iterdir())
    inodes = {found[1] for link in links if (found := re.match(r"socket:\[(\d+)\]", link))}
    for line in Path(f"/proc/{pid}/net/udp").read_text().splitlines()[1:]:
        fields = line.split()
        if fields[9] in inodes:
            yield int(fields[1].partition(":")[2], 16)


@pytest.mark.parametrize(
    ("command", "given", "network"),
    [
        (("furuta_friction", "friction_observer"), {}, False),
        (("furuta_hw", "hardware_bridge"), {RANGE: "SUBNET"}, True),
    ],
    ids=["default", "chosen"],
)
def test_a_node_joins_no_multicast(
    processes: Any, choose: Any, command: tuple[str, str], given: dict[str, str], network: bool
) -> None:
    """``ros2 run`` starts these executables, and sets nothing."""
    choose(**given)
    process = processes.start(executable(*command))
    lines = [process.stderr.readline()]
    while "ready" not in lines[-1]:
        lines.append(process.stderr.readline())
        assert lines[-1], "".join(lines)
    assert (MULTICAST_PORT in udp_ports(process.pid)) == network
    assert ("[discovery]: the network" in "".join(lines)) == network
