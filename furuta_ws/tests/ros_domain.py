"""Gives each test process a ROS domain of its own on this machine."""

from __future__ import annotations

import fcntl
import os
import tempfile
from pathlib import Path
from typing import Any

DOMAINS = range(1, 100)
# Where the middleware keeps its ports, the first one of domain 0, and how many a domain has.
SHARED_MEMORY = Path("/dev/shm")
FIRST_PORT, PORTS = 7400, 250


def take_domain() -> Any:
    """Take the first ROS domain that no other test process holds; keep the result while alive.

    Call it before ROS starts, which reads the domain.
    """
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    for domain in DOMAINS:
        lock = (Path(tempfile.gettempdir()) / f"furuta-test-domain-{domain}").open("w")
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            lock.close()
            continue
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        _remove_leftovers(domain)
        return lock
    raise RuntimeError("every ROS domain for tests is taken")


def _remove_leftovers(domain: int) -> None:
    """Remove empty ports in shared memory: every later process that opens one waits for ever.

    A process that is killed between making and filling a port leaves it empty.
    """
    first = FIRST_PORT + PORTS * domain
    for port in range(first, first + PORTS):
        file = SHARED_MEMORY / f"fastrtps_port{port}"
        if file.exists() and file.stat().st_size == 0:
            file.unlink(missing_ok=True)
