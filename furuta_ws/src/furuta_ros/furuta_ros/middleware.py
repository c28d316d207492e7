"""What the middleware is told before ROS starts: which processes to discover, and on which ports.

ROS itself joins the network by default. A graph that drives a rig must not, so a process of this
project sets ``ROS_AUTOMATIC_DISCOVERY_RANGE`` before ROS starts, if the user has chosen nothing.
A port is one of UDP, and a file of the same number in shared memory.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import time

RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
PEERS = "ROS_STATIC_PEERS"
SERVER = "ROS_DISCOVERY_SERVER"
# An earlier variable of ROS, which still has precedence if it is 1.
LOCALHOST_ONLY = "ROS_LOCALHOST_ONLY"
# Names a file with settings of Fast DDS.
PROFILES = "FASTRTPS_DEFAULT_PROFILES_FILE"

SHARED_MEMORY = Path("/dev/shm")
# The first port of domain 0, and the ports of a domain (DDS Interoperability Protocol, 9.6.2).
FIRST_PORT, PORTS = 7400, 250
# A port that is older than this [s] and still empty is not being created any more.
CREATION_TIME = 0.2
# Variable of middleware.xml: from which port of the domain Fast DDS looks for a free one for data.
DATA_PORT = "FURUTA_DATA_PORT"
# The ports to choose from. Those of discovery are even.
DATA_PORTS = range(11, 211, 2)


def ros_domain() -> int:
    """The ROS domain of a process that has not started ROS yet."""
    given = os.environ.get("ROS_DOMAIN_ID", "")
    return int(given) if given.isdecimal() else 0  # ROS itself rejects anything but a number


def restrict_discovery() -> None:
    """Choose this machine only, if no environment variable holds another choice."""
    if not any(os.environ.get(name) for name in (RANGE, PEERS, SERVER)):
        os.environ[RANGE] = "LOCALHOST"


def prepare_middleware() -> None:
    """Make these choices for this process, before ROS starts."""
    restrict_discovery()
    # Processes discover each other without delay, if the user has chosen no settings.
    os.environ.setdefault(PROFILES, str(Path(__file__).with_name("middleware.xml")))
    remove_empty_ports()
    choose_data_port()


@contextmanager
def no_discovery() -> Iterator[None]:
    """ROS started inside the ``with`` block discovers no other process, whatever was chosen."""
    names = (RANGE, PEERS, SERVER, LOCALHOST_ONLY)
    chosen = {name: os.environ.pop(name) for name in names if name in os.environ}
    os.environ[RANGE] = "OFF"
    try:
        yield
    finally:
        del os.environ[RANGE]
        os.environ.update(chosen)


def is_private() -> bool:
    """Whether this process discovers no other."""
    return os.environ.get(RANGE) == "OFF" and os.environ.get(LOCALHOST_ONLY) != "1"


def reaches_network() -> bool:
    """Whether nodes of other machines can discover the nodes of this process."""
    given = os.environ.get(RANGE, "")
    if os.environ.get(LOCALHOST_ONLY) == "1" or given == "OFF":
        return False
    chosen = any(os.environ.get(name) for name in (PEERS, SERVER))
    return chosen or given in ("", "SUBNET", "SYSTEM_DEFAULT")


def clock_advice() -> str:
    """What to do about messages with a wrong time, where other computers can send some."""
    return "; if they come from another computer, set both clocks" if reaches_network() else ""


def describe_discovery() -> str:
    """The choice that applies, with the variables that make it."""
    reached = "the network" if reaches_network() else "this machine only"
    variables = [name for name in (LOCALHOST_ONLY, RANGE, PEERS, SERVER) if os.environ.get(name)]
    return f"{reached} ({', '.join(f'{name}={os.environ[name]}' for name in variables)})"


def port_file(port: int, directory: Path = SHARED_MEMORY) -> Path:
    """The file of a ``port`` of this process's ROS domain."""
    return directory / f"fastrtps_port{FIRST_PORT + PORTS * ros_domain() + port}"


def remove_empty_ports(directory: Path = SHARED_MEMORY) -> None:
    """Remove the empty ports of this process's ROS domain.

    A process that is killed between creating and filling its port in shared memory leaves an empty
    file. Every process that starts on this port later, or sends to it, would wait for it forever.
    """
    for port in range(PORTS):
        file = port_file(port, directory)
        with suppress(OSError):
            status = file.stat()
            if status.st_size == 0 and time() - status.st_mtime > CREATION_TIME:
                file.unlink()


def choose_data_port(directory: Path = SHARED_MEMORY) -> None:
    """Let this process take a port that no other one had, or else the one taken longest ago.

    A process with the port of one that was just killed gets no response from those that still
    remember the killed one. The file of a port stays if its process is killed.
    """

    def taken(port: int) -> tuple[float, int]:
        """When the port was taken, 0 for never, and a number that differs between processes."""
        try:
            when = port_file(port, directory).stat().st_mtime
        except OSError:
            when = 0.0
        return when, (port // 2 - os.getpid()) % len(DATA_PORTS)

    os.environ[DATA_PORT] = str(min(DATA_PORTS, key=taken))
