"""What killed processes leave in shared memory does not block later ones."""

import os
from pathlib import Path
from time import time

import pytest
from rclpy.node import Node

from furuta_ros.context import (
    FIRST_PORT,
    PORTS,
    SHARED_MEMORY,
    remove_empty_ports,
    ros_context,
)


def port(directory: Path, domain: int, content: bytes = b"", age: float = 10.0) -> Path:
    """A port of a domain, last written ``age`` seconds ago."""
    file = directory / f"fastrtps_port{FIRST_PORT + PORTS * domain + 11}"
    file.write_bytes(content)
    os.utime(file, (time() - age, time() - age))
    return file


def test_only_old_empty_ports_of_this_domain_are_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A port in use has content; one that is being created is young."""
    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    other = port(tmp_path, 8)
    for content, age, removed in ((b"x", 10.0, False), (b"", 0.0, False), (b"", 10.0, True)):
        file = port(tmp_path, 7, content, age)
        remove_empty_ports(tmp_path)
        assert file.exists() is not removed
    assert other.exists()


@pytest.mark.skipif(not SHARED_MEMORY.is_dir(), reason="needs /dev/shm")
@pytest.mark.timeout(60)
def test_a_node_starts_on_an_empty_port() -> None:
    """Without the removal it would wait forever."""
    file = port(SHARED_MEMORY, int(os.environ["ROS_DOMAIN_ID"]))
    with ros_context():
        Node("started").destroy_node()
    assert not file.exists() or file.stat().st_size > 0
