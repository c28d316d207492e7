"""Every import is declared, and every declared dependency can be installed."""

import re
import sys
from collections.abc import Iterable
from glob import glob
from pathlib import Path

import pytest
from sources import (
    PACKAGES,
    ROOT,
    SITE,
    SOURCES,
    TESTS,
    imports,
    keys,
    modules,
    product_requirements,
    setup_options,
)

from furuta.settings.nodes import NODES

# How rosdep installs a key on Ubuntu 24.04. Source: rosdep/python.yaml and jazzy/distribution.yaml
# of github.com/ros/rosdistro at commit 8468e88ccd523427f9131e39d2af0938f1c298b2.
APT = {
    "python3-catkin-pkg-modules",
    *(
        "python3-click",
        "python3-hypothesis",
        "python3-matplotlib",
        "python3-mypy",
    ),
    *("python3-numba", "python3-numpy", "python3-pytest", "python3-pytest-timeout", "python3-rich"),
    *("python3-scipy", "python3-serial", "python3-types-pyyaml", "python3-websockets"),
    "python3-yaml",
}
ROS = {
    *("ament_index_python", "diagnostic_msgs", "launch", "launch_ros", "lifecycle_msgs", "rclpy"),
    *("rcl_interfaces", "ros2launch", "rosgraph_msgs", "sensor_msgs", "std_msgs", "std_srvs"),
    *("robot_state_publisher", "urdfdom_py", "xacro"),
}
# pip refuses these there (PEP 668) unless PIP_BREAK_SYSTEM_PACKAGES is set.
PIP = {
    "mcap-ros2-support": "mcap-ros2-support",  # needs mcap, which has no key
    "python-cobs-pip": "cobs",
    "python-control-pip": "control",
    "python3-rosbags-pip": "rosbags",
    "python3-ruff-pip": "ruff",
}
# rosdep has no key for these, or few need them: setup.cfg declares them as extras.
WITHOUT_KEY = {
    *("axe_playwright_python", "distributed", "flint", "gymnasium", "pandas", "playwright"),
    *("pyarrow", "unicorn", "xarray", "ziglang"),
}

# The key of each import that has another name.
KEY_OF_IMPORT = {
    "cobs": "python-cobs-pip",
    "control": "python-control-pip",
    "mcap": "mcap-ros2-support",
    "rosbags": "python3-rosbags-pip",
    "ruff": "python3-ruff-pip",
    "urdf_parser_py": "urdfdom_py",
    **{name.removeprefix("python3-"): name for name in APT},
}
# What tests need without importing it: plugins, and commands with the types that they check.
PLUGINS = {"pytest-timeout"}
COMMANDS = {"mypy", "types-pyyaml", "ruff"}
TAGS = ("depend", "buildtool_depend", "exec_depend", "test_depend")
# The requirement of each import that has another name or comes with another package.
REQUIREMENT_OF_IMPORT = {
    "PIL": "pillow",
    "flint": "python-flint",
    "serial": "pyserial",
    "yaml": "pyyaml",
    "dask": "distributed",
    "urdf_parser_py": "urdf-parser-py",
    **dict.fromkeys(ROS, "ros-jazzy-rclpy"),
    **dict.fromkeys({"diagnostic_msgs", "sensor_msgs", "std_msgs"}, "ros-jazzy-common-interfaces"),
    "std_srvs": "ros-jazzy-common-interfaces",
}
# Folders with a ``requirements.in``.
REQUIREMENTS = (".", "benchmarks", "course", "docs", "examples", "firmware", "furuta_ws/tests")
# Only where ROS is installed; the launch file needs them.
ONLY_WITH_ROS = {"launch", "launch_ros"}


def files_of_tests(package: str) -> set[Path]:
    """The tests of a package, with the helpers in tests/ that they import."""
    files = set(map(Path, glob(f"{SOURCES / package / 'test'}/**/*.py", recursive=True)))
    found: set[Path] = set()
    while files - found:
        found |= files
        files = {TESTS / f"{name}.py" for name in imported(found)} & set(TESTS.glob("*.py"))
    return found


def imported(files: Iterable[Path]) -> set[str]:
    """What files import from outside the standard library."""
    return set().union(*map(imports, files)) - sys.stdlib_module_names


def helpers() -> set[str]:
    """What tests import from tests/ itself, and from the scripts of the site."""
    return {path.stem for path in (*TESTS.iterdir(), *SITE.glob("*.py"))} - set(PACKAGES)


def assert_declared(names: set[str], found: set[str], extras: list[str]) -> None:
    """Each import has its key, or its extra if there is no key; nothing else is declared."""
    assert {KEY_OF_IMPORT.get(name, name) for name in names - WITHOUT_KEY} == found
    assert {REQUIREMENT_OF_IMPORT.get(name, name) for name in names & WITHOUT_KEY} == set(extras)


def extras(package: str) -> dict[str, list[str]]:
    """The extras of a package's setup.cfg."""
    section = setup_options(package)["options.extras_require"]
    return {key: value.split() for key, value in section.items()}


@pytest.mark.parametrize("package", PACKAGES)
def test_imports_are_declared(package: str) -> None:
    """In package.xml, to be installed with the package."""
    names = imported([*modules(package), *(SOURCES / package / "launch").glob("*.py")]) - {package}
    if package == "furuta_bringup":  # its launch file starts executables of other packages
        names |= {"ros2launch", *(node.package for node in NODES.values())}
    if package == "furuta_description":  # its launch file starts it, and RViz, which is large
        names |= {"robot_state_publisher"}
    optional = [each for name, group in extras(package).items() if name != "test" for each in group]
    assert_declared(names, keys(package, "depend", "exec_depend"), optional)


@pytest.mark.parametrize("package", PACKAGES)
def test_imports_of_tests_are_declared(package: str) -> None:
    """In package.xml, unless the package needs them; colcon looks for pytest in setup.cfg."""
    names = imported(files_of_tests(package)) - helpers() - {package} | PLUGINS
    if package == "furuta_bringup":
        names |= COMMANDS
    runtime = keys(package, "depend", "exec_depend")
    names = {name for name in names if KEY_OF_IMPORT.get(name, name) not in runtime}
    pytest_extra, *others = extras(package)["test"]
    assert pytest_extra == "pytest"
    assert_declared(names, keys(package, "test_depend"), others)


def test_keys_are_known_to_rosdep() -> None:
    """Each key of each package.xml is one that rosdep or the workspace has."""
    used = set().union(*(keys(package, *TAGS) for package in PACKAGES))
    assert used - set(PACKAGES) == APT | ROS | PIP.keys()


def test_imports_are_required() -> None:
    """Directly, whatever is imported, not what happens to come along."""
    files = (ROOT / folder / "requirements.in" for folder in REQUIREMENTS)
    required = set(re.findall(r"^[\w-]+", "\n".join(f.read_text() for f in files), re.MULTILINE))
    required |= {re.split(r"[\[>]", each)[0] for each in product_requirements()}
    folders = (ROOT / "benchmarks", ROOT / "examples", SITE)
    scripts = {file for folder in folders for file in folder.glob("*.py")}
    tests = [TESTS.parent / "conftest.py", *TESTS.rglob("*.py")]
    sources = (file for package in PACKAGES for file in modules(package))
    own = helpers() | set(PACKAGES) | {file.stem for file in scripts}
    names = imported([*scripts, *tests, *sources]) - own - ONLY_WITH_ROS
    assert {REQUIREMENT_OF_IMPORT.get(name, name) for name in names} <= required
