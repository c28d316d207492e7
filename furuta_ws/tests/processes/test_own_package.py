"""The package in ``examples``: built, tested, launched and run by the commands of its page."""

import runpy
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import commands
import pytest
from sources import ROOT, SOURCES

from furuta_bringup.launching import launched_nodes

PAGE = ROOT / "docs" / "own-package.md"
EXAMPLE = ROOT / "examples" / "my_furuta_package"
WORKSPACE = "../my_ws"


def steps(heading: str) -> list[str]:
    """The commands of a section of the page that need no ``ros2``."""
    found = [block for block in commands.blocks(PAGE) if block.heading == heading]
    given = [commands.without_comment(each) for block in found for each in block.commands]
    return [each for each in given if not each.startswith(("ros2", "tools/in_environment"))]


def test_it_is_built_tested_and_run_as_its_page_says(tmp_path: Path) -> None:
    """From the clone, in one shell, with a workspace elsewhere."""
    given = [*steps("Build and test it"), *steps("Run it")]
    assert {"colcon build", "colcon test"} <= {each.partition(" --")[0] for each in given}
    script = "\n".join(given).replace(WORKSPACE, str(tmp_path / "my_ws"))
    done = subprocess.run(
        ["bash", "-e", "-c", script], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "2 tests, 0 errors, 0 failures, 0 skipped" in done.stdout
    assert "20000 samples, 20.000 s" in done.stdout
    results = tmp_path / "my_ws" / "build" / "my_furuta_package" / "pytest.xml"
    assert "test_the_arm_swings_less" in results.read_text()


def test_page_shows_the_test_of_the_package() -> None:
    """As it is."""
    _, _, code = (EXAMPLE / "test" / "test_closed_loop.py").read_text().partition("\n\n")
    assert code.strip() in PAGE.read_text()


def test_launch_file_leaves_our_observer_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """It includes our launch file with arguments that this accepts, and starts the node instead.

    Stand-ins for ``launch``, where that is not installed, keep what they are called with.
    """
    made: list[dict[str, Any]] = []

    def entity(*given: Any, **named: Any) -> None:
        made.append({"given": given, **named})

    for name in ("launch", "launch.actions", "launch_ros", "launch_ros.actions"):
        stand_in = ModuleType(name)
        for each in ("LaunchDescription", "IncludeLaunchDescription", "Node"):
            setattr(stand_in, each, entity)
        monkeypatch.setitem(sys.modules, name, stand_in)
    share = {"furuta_bringup": SOURCES / "furuta_bringup", "my_furuta_package": EXAMPLE}
    monkeypatch.setattr("ament_index_python.packages.get_package_share_directory", share.get)
    launch_file = runpy.run_path(str(EXAMPLE / "launch" / "my_furuta.launch.py"))
    launch_file["generate_launch_description"]()
    included, node, _ = made
    assert Path(*included["given"]).is_file()
    ours = launched_nodes(**dict(included["launch_arguments"]))
    assert [each["name"] for each in ours] == ["plant", "estimator", "controller"]
    assert (node["name"], node["executable"]) == ("friction_observer", "my_observer")
    assert Path(*node["parameters"]).is_file()
