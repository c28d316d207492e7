"""Gives each test process a ROS domain of its own on this machine."""

import fcntl
import os
import tempfile
from pathlib import Path
from typing import Any

DOMAINS = range(1, 100)


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
        return lock
    raise RuntimeError("every ROS domain for tests is taken")
