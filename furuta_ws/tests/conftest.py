"""Fixtures for all tests: a separate ROS domain for each process, ROS, and a test bench."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml
from ros_domain import take_domain

_DOMAIN_LOCK = take_domain()

# The domain is read when ROS starts.
from testbench import Bench  # noqa: E402

from furuta_graph.rigs import rig_directory  # noqa: E402
from furuta_graph.settings import Settings, default_settings  # noqa: E402
from furuta_ros.context import ros_context  # noqa: E402


@pytest.fixture
def ros() -> Iterator[None]:
    """ROS from start to end of a test."""
    with ros_context():
        yield


@pytest.fixture
def bench(ros: None) -> Iterator[Bench]:
    """A test bench for nodes."""
    bench = Bench()
    yield bench
    bench.close()


@pytest.fixture
def other_rig(tmp_path: Path) -> Path:
    """A rig file with another model, other limits and another sample time than the paper's."""
    content = yaml.safe_load((rig_directory() / "qube_servo_2.yaml").read_text())
    content["line"]["sample_time"] = 0.002
    content["limits"]["voltage"] = 5.0
    file = tmp_path / "other_rig.yaml"
    file.write_text(yaml.safe_dump(content))
    return file


@pytest.fixture
def settings() -> Settings:
    """Settings that leave every parameter at its default."""
    return default_settings()
