"""What killed processes leave in shared memory does not block later ones."""

import os
from pathlib import Path
from time import time

import pytest
from rclpy.node import Node

from furuta_ros.middleware import (
    DATA_PORT,
    DATA_PORTS,
    SHARED_MEMORY,
    choose_data_port,
    port_file,
    remove_empty_ports,
)
from furuta_ros.spinning import ros_context


def port(directory: Path, content: bytes = b"", age: float = 10.0, number: int = 11) -> Path:
    """A port of this process's domain, last written ``age`` seconds ago."""
    file = port_file(number, directory)
    file.write_bytes(content)
    os.utime(file, (time() - age, time() - age))
    return file


def test_only_old_empty_ports_of_this_domain_are_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A port in use has content; one that is being created is young."""
    monkeypatch.setenv("ROS_DOMAIN_ID", "8")
    other = port(tmp_path)
    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    for content, age, removed in ((b"x", 10.0, False), (b"", 0.0, False), (b"", 10.0, True)):
        file = port(tmp_path, content, age)
        remove_empty_ports(tmp_path)
        assert file.exists() is not removed
    assert other.exists()


def test_a_port_is_the_one_taken_longest_ago(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A process that was just killed is still remembered by others, with its port."""
    monkeypatch.setenv(DATA_PORT, "")  # and give back the one of this process
    chosen = []
    for age in range(len(DATA_PORTS), -1, -1):
        choose_data_port(tmp_path)
        chosen.append(int(os.environ[DATA_PORT]))
        port(tmp_path, b"x", age, number=chosen[-1])
    assert sorted(chosen[:-1]) == list(DATA_PORTS)
    assert chosen[-1] == chosen[0]


@pytest.mark.skipif(not SHARED_MEMORY.is_dir(), reason="needs /dev/shm")
@pytest.mark.timeout(60)
def test_a_node_starts_on_an_empty_port() -> None:
    """Without the removal it would wait forever."""
    file = port(SHARED_MEMORY)
    with ros_context():
        Node("started").destroy_node()
    assert not file.exists() or file.stat().st_size > 0
