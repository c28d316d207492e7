"""Removes what killed processes leave in the middleware's shared memory.

A process that is killed between creating and filling its port leaves an empty file. Every process
that starts on this port later, or sends to it, would wait for it forever.
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from time import time

SHARED_MEMORY = Path("/dev/shm")
# The first port of domain 0, and the ports of a domain (DDS Interoperability Protocol, 9.6.2).
FIRST_PORT, PORTS = 7400, 250
# A port that is older than this [s] and still empty is not being created any more.
CREATION_TIME = 0.2


def remove_empty_ports(directory: Path = SHARED_MEMORY) -> None:
    """Remove the empty ports of this process's ROS domain."""
    domain = os.environ.get("ROS_DOMAIN_ID", "0")
    if not domain.isdecimal():
        return  # ROS itself rejects it
    first = FIRST_PORT + PORTS * int(domain)
    for port in range(first, first + PORTS):
        file = directory / f"fastrtps_port{port}"
        with suppress(OSError):
            status = file.stat()
            if status.st_size == 0 and time() - status.st_mtime > CREATION_TIME:
                file.unlink()
