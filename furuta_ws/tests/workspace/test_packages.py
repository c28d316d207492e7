"""What ROS tools rely on in the install space, and the shape of the workspace."""

import ast
import os
import re
import stat
import subprocess
import sys
from graphlib import CycleError, TopologicalSorter
from importlib.util import find_spec
from pathlib import Path

import pytest
from ament_index_python.packages import get_package_share_directory
from sources import PACKAGES, ROOT, SOURCES, imports, modules

from furuta.settings.nodes import NODES
from furuta.settings.settings import read_file
from furuta_bringup.graph.processes import executable
from furuta_bringup.parameter_files import parameter_file
from furuta_model.parameters import declared

# Who may import whom: each package only those further left, siblings in one group not each other.
LAYERS = [
    {"furuta_model"},
    {"furuta_ros"},
    {"furuta_friction", "furuta_recordings"},
    {"furuta_control"},
    {"furuta_sim"},
    {"furuta_hw"},
    {"furuta", "furuta_description"},
    {"furuta_bringup"},
]
# Modules that know ROS; every other module of the workspace is pure.
ROS_MODULES = {
    *("rclpy", "rcl_interfaces", "sensor_msgs", "std_msgs", "std_srvs", "diagnostic_msgs"),
    *("lifecycle_msgs", "rosgraph_msgs"),
}
PURE = ["furuta", "furuta_model"]
# Here only the nodes, and the files named below, import ROS.
WITH_NODES = ["furuta_sim", "furuta_control", "furuta_friction", "furuta_hw", "furuta_recordings"]
ROS_FILES = {"lockstep", "realtime", "recorder_process", "simulated_plant"}


def cores(package: str) -> list[Path]:
    """The modules that must not know ROS."""
    return [
        file
        for file in modules(package)
        if package in PURE or not (file.stem.endswith("_node") or file.stem in ROS_FILES)
    ]


def module_name(file: Path) -> str:
    return ".".join(file.relative_to(SOURCES).with_suffix("").parts[1:]).removesuffix(".__init__")


def imported_modules(file: Path) -> set[str]:
    """Full names that a file imports when it is loaded, or for types: not inside functions."""
    nodes: list[ast.AST] = [ast.parse(file.read_text())]
    names = set()
    while nodes:
        node = nodes.pop()
        if not isinstance(node, ast.FunctionDef):
            nodes += ast.iter_child_nodes(node)
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return names


def test_colcon_takes_every_package_for_ament_python() -> None:
    """An invalid package.xml would silently demote a package to plain python."""
    listing = subprocess.run(
        ["colcon", "--log-base", os.devnull, "list", "--base-paths", str(SOURCES)],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    types = {line.split()[0]: line.split()[-1] for line in listing.splitlines()}
    assert types == dict.fromkeys(PACKAGES, "(ros.ament_python)")


@pytest.mark.parametrize("name", NODES)
def test_nodes_are_where_ros2_run_looks(name: str) -> None:
    """Executable in lib/<package>, which has the class too."""
    node = NODES[name]
    path = executable(node.package, node.executable)
    assert path.parent.name == node.package
    assert path.stat().st_mode & stat.S_IXUSR
    assert node.load_class().__module__.partition(".")[0] == node.package


def test_packages_import_downward_only() -> None:
    """No package knows one above it or beside it."""
    for level, layer in enumerate(LAYERS):
        for package in layer:
            allowed = set().union({package}, *LAYERS[:level])
            for file in modules(package):
                assert imports(file) & set(PACKAGES) <= allowed, file


def test_modules_form_no_circle() -> None:
    """No module loads one that loads it, directly or through others, not even for types.

    A method may import what it calls, such as the figure of its result.
    """
    files = {module_name(file): file for package in PACKAGES for file in modules(package)}
    graph = {name: imported_modules(file) & set(files) - {name} for name, file in files.items()}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail("import circle: " + " imports ".join(reversed(error.args[1])))


def test_cores_load_no_ros() -> None:
    """Not even by other modules: without ROS a simulation runs and a recording is read."""
    missing = {name for name in ("flint", "gymnasium") if find_spec(name) is None}
    files = (file for package in (*PURE, *WITH_NODES) for file in cores(package))
    names = [module_name(file) for file in files if not imports(file) & missing]
    code = f"import sys, {', '.join(names)}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.split())
    assert {"furuta_recordings.readers", "furuta_recordings.bags.bag"} <= loaded
    assert not loaded & ROS_MODULES


@pytest.mark.parametrize("node", NODES)
def test_parameter_files_are_the_declarations(node: str) -> None:
    """config/ holds what ``furuta param defaults`` prints, and reads back as the defaults."""
    file = ROOT / "furuta_ws" / "config" / f"{node}.yaml"
    assert file.read_text() == parameter_file(node)
    installed = Path(get_package_share_directory("furuta_bringup")) / "config" / file.name
    assert installed.read_text() == file.read_text()
    given = read_file(file)[node]
    assert given == {each.name: each.default for each in declared(NODES[node].parameters)}


@pytest.mark.parametrize(
    "command",
    [
        "ruff check .",
        "ruff format --check .",
        # .ci/run calls it itself: without its cache it takes as long as a tenth of make test.
        pytest.param("mypy furuta_ws/src benchmarks course docs/site", marks=pytest.mark.long),
    ],
)
def test_lint_and_types(command: str) -> None:
    """The house style holds."""
    done = subprocess.run(command.split(), cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_nothing_names_what_others_may_own() -> None:
    """No package of a registry, repository or address with our name: they are not ours."""
    folders = [SOURCES, *(ROOT / name for name in ("docs", "course", "examples", "tools"))]
    suffixes = {".py", ".md", ".xml", ".cfg", ".properties", ".yaml", ".toml", ".in", ".cff", ""}
    files = [*ROOT.iterdir(), *(file for folder in folders for file in folder.rglob("*"))]
    strange = re.compile(r"pip install '?furuta(\[|\b(?!-))|github\.com/furuta|noreply")
    for file in files:
        if file.is_file() and file.suffix in suffixes and file.name != ".git":
            text = file.read_text(encoding="utf-8", errors="replace")
            assert not strange.search(text), file
