"""Fixtures for all tests: a separate ROS domain for each process, ROS, and a test bench."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from ros_domain import take_domain

if TYPE_CHECKING:
    from furuta.settings.settings import Settings
    from furuta_ros.testing import Bench

SOURCES = Path(__file__).resolve().parent / "src"

_DOMAIN_LOCK = take_domain()

# Tests run against the installed packages. ``colcon test`` starts ``python -m pytest`` in the
# folder of a package in src/, and Python would import the package from there.
sys.path[:] = [path for path in sys.path if Path(path).resolve().parent != SOURCES]

# Folders whose tests take long; all others come first, so that a failure shows early. The last one
# has many short files, so that all workers end at the same time.
SLOW = ("processes", "workspace", "graph", "proofs", "soak", "identification", "furuta")

# What some files of tests import, and rosdep does not install, or in an old version.
OPTIONAL = ("distributed", "flint", "gymnasium", "websockets")


class FileOfTests(pytest.Module):
    """A file of tests, skipped if it imports an optional package that is not installed."""

    def collect(self) -> Iterable[pytest.Item | pytest.Collector]:
        """Its tests."""
        try:
            return list(super().collect())
        except self.CollectError as error:
            name = (getattr(error.__cause__, "name", None) or "").partition(".")[0]
            if name in OPTIONAL:
                pytest.skip(f"{name} is not installed, or too old")
            raise


def pytest_pycollect_makemodule(module_path: Path, parent: pytest.Collector) -> pytest.Module:
    """Skip a file that lacks an optional package."""
    return FileOfTests.from_parent(parent, path=module_path)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the fast tests first; the order within a file stays."""
    rank = {folder: place for place, folder in enumerate(SLOW, 1)}
    items.sort(key=lambda item: rank.get(item.path.parent.name, 0))


# Each fixture imports what it needs: with ``colcon test``, only the package under test and its
# dependencies are in the environment.


@pytest.fixture
def ros() -> Iterator[None]:
    """ROS from start to end of a test."""
    from furuta_ros.spinning import ros_context

    with ros_context():
        yield


@pytest.fixture
def bench(ros: None) -> Iterator[Bench]:
    """A test bench for nodes, which nodes of other processes discover."""
    from furuta_ros.testing import Bench

    with Bench() as bench:
        yield bench


@pytest.fixture
def other_rig(tmp_path: Path) -> Path:
    """A rig file with another model, other limits and another sample time than the paper's."""
    import yaml

    from furuta_hw.rigs.known_rigs import rig_directory

    content = yaml.safe_load((rig_directory() / "qube_servo_2.yaml").read_text())
    content["line"]["sample_time"] = 0.002
    content["limits"]["voltage"] = 5.0
    file = tmp_path / "other_rig.yaml"
    file.write_text(yaml.safe_dump(content))
    return file


@pytest.fixture
def no_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """The process accepts no parts of the user's own before the test, and none of its own after."""
    from furuta_control.control import design_controller
    from furuta_control.estimation import design_estimator
    from furuta_friction.compensation import design_compensator
    from furuta_model import accepted_parts

    for design in (design_controller, design_estimator, design_compensator):
        design.cache_clear()  # type: ignore[attr-defined]
    monkeypatch.setattr(accepted_parts, "_accepted", {})
    monkeypatch.setattr(accepted_parts, "_imported_names", [])


@pytest.fixture
def evil(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, no_parts: None) -> Path:
    """A working directory with a module ``evil``; loading it sets ``sys.loaded_evil``."""
    from own_parts import EVIL

    (tmp_path / "evil.py").write_text(EVIL)
    monkeypatch.chdir(tmp_path)
    monkeypatch.delattr(sys, "loaded_evil", raising=False)
    return tmp_path


@pytest.fixture
def settings() -> Settings:
    """Settings that leave every parameter at its default."""
    from furuta.settings.settings import default_settings

    return default_settings()
