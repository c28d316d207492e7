"""The ports of this process: those of UDP, and the files of the same numbers in shared memory."""

import os
from contextlib import suppress
from pathlib import Path
from time import time

SHARED_MEMORY = Path("/dev/shm")
# The first port of domain 0, and the ports of a domain (DDS Interoperability Protocol, 9.6.2).
FIRST_PORT, PORTS = 7400, 250
# A port that is older than this [s] and still empty is not being created any more.
CREATION_TIME = 0.2
# Variables of middleware.xml: from which ports of the domain Fast DDS looks for two free ones.
DISCOVERY_PORT, DATA_PORT = "FURUTA_DISCOVERY_PORT", "FURUTA_DATA_PORT"
# The first of these ports, and how many pairs there are: every process finds those up to 72.
OFFSET, PAIRS = 10, 24


def port_file(port: int, directory: Path = SHARED_MEMORY) -> Path:
    """The file of a ``port`` of this process's ROS domain."""
    domain = os.environ.get("ROS_DOMAIN_ID", "0")
    # ROS itself rejects anything but a number.
    number = FIRST_PORT + PORTS * int(domain if domain.isdecimal() else 0) + port
    return directory / f"fastrtps_port{number}"


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


def choose_ports(directory: Path = SHARED_MEMORY) -> None:
    """Let this process take ports that no other one had, or else those that were taken first.

    A process with the ports of one that was just killed gets no response from those that still
    remember the killed one. The file of a port stays if its process is killed.
    """

    def taken(pair: int) -> tuple[float, int]:
        """When the pair was taken, 0 for never, and a number that differs between processes."""
        try:
            when = port_file(OFFSET + 2 * pair + 1, directory).stat().st_mtime
        except OSError:
            when = 0.0
        return when, (pair - os.getpid()) % PAIRS

    port = OFFSET + 2 * min(range(PAIRS), key=taken)
    os.environ.update({DISCOVERY_PORT: str(port), DATA_PORT: str(port + 1)})
