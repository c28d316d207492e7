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
# Variable of middleware.xml: from which port of the domain Fast DDS looks for a free one for data.
DATA_PORT = "FURUTA_DATA_PORT"
# The ports to choose from. Those of discovery are even.
DATA_PORTS = range(11, 211, 2)


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
