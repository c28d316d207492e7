"""The wheel: it holds the library and the command line, and needs no ROS."""

import os
import subprocess
import sys
from pathlib import Path
from zipfile import ZipFile

import pytest
from sources import PACKAGES, ROOT, manifest

# The lines of README.
LINES = """
import furuta
loop = furuta.make_loop({"omega1": 7.0})
run = furuta.simulate(loop, seconds=1.0)
cycle = furuta.limit_cycle(loop)
print(f"{cycle.phi_peak_to_peak_rad:.3f} rad, {cycle.period_s:.2f} s")
"""
# What a computer without ROS and without colcon does not have.
MISSING = ("rclpy", "ament_index_python", "rcl_interfaces", "sensor_msgs", "std_msgs", "std_srvs")
WITHOUT_ROS = f"""
import sys
from importlib.abc import MetaPathFinder

class Refuse(MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {MISSING}:
            raise ModuleNotFoundError(f"no {{name}} here", name=name)

sys.meta_path.insert(0, Refuse())
"""
VERBS = """
from click.testing import CliRunner
from furuta_bringup.main import furuta as command, VERBS
print("from", furuta.__file__, "version", furuta.__version__, furuta.load_rig("qube_servo_2"))
ready = []
for verb in VERBS:
    done = CliRunner().invoke(command, [verb, "--help"])
    ready += [verb] if done.exit_code == 0 else []
    assert done.exit_code == 0 or "which is not installed" in str(done.exception), done
print(*ready)
print(CliRunner().invoke(command, ["view", "--no-open"]).exception)
print(CliRunner().invoke(command, ["--version"]).output)
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel as ``make wheel`` builds it."""
    pytest.importorskip("hatchling")
    directory = Path(tmp_path_factory.mktemp("wheel"))
    options = ["--disable-pip-version-check", "--quiet", "--no-deps", "--no-build-isolation"]
    subprocess.run(
        [sys.executable, "-m", "pip", "wheel", *options, "--wheel-dir", directory, ROOT], check=True
    )
    (file,) = directory.glob("*.whl")
    return file


def environment(**more: str) -> dict[str, str]:
    """The environment without the workspace."""
    kept = {name: value for name, value in os.environ.items() if not name.endswith("PATH")}
    return {**kept, "PATH": os.environ["PATH"], **more}


def test_wheel_is_pure_and_has_the_one_version(wheel: Path) -> None:
    """The version is that of package.xml; every package is in it."""
    assert wheel.name == f"furuta-{manifest('furuta').findtext('version')}-py3-none-any.whl"
    content = ZipFile(wheel).namelist()
    packages = {name.partition("/")[0] for name in content if name.endswith("/__init__.py")}
    assert packages == set(PACKAGES)
    assert all(f"{package}/py.typed" in content for package in packages)
    assert "furuta_ros/share/furuta_bringup/config/rigs/paper.yaml" in content
    page = "furuta_bringup/page/web"
    assert "furuta_bringup/page/furuta.html.gz" in content
    assert {f"{page}/{name}" for name in ("page.html", "three.js", "three.LICENSE")} <= set(content)


@pytest.mark.long
def test_wheel_works_without_ros(wheel: Path, tmp_path: Path) -> None:
    """Unpacked, with nothing of the workspace or of ROS: five lines, rigs, and the verbs.

    Compilation is off: the functions are the same ones, run by Python.
    """
    ZipFile(wheel).extractall(tmp_path)
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_ROS + LINES + VERBS],
        env=environment(PYTHONPATH=str(tmp_path), NUMBA_DISABLE_JIT="1"),
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    cycle, about, verbs, view, version = done.stdout.strip().splitlines()
    assert cycle == "0.511 rad, 2.37 s"
    assert str(tmp_path) in about
    assert "FurutaPendulum(" in about
    assert {"simulate", "limit-cycle", "identify", "sweep", "bag", "page"} <= set(verbs.split())
    assert view.startswith("furuta view needs ") and ", which is not installed: " in view
    assert view.endswith("; furuta page opens the simulation without it")
    assert version == f"furuta {manifest('furuta').findtext('version')}"
