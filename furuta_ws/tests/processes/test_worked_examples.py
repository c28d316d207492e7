"""The worked examples of docs/extending.md, applied to a copy of the sources and run."""

import json
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).resolve().parents[3]
PAGE = ROOT / "docs" / "extending.md"
SOURCES = Path("furuta_ws") / "src"

_BLOCK = re.compile(r"^```(\w+) title=(\S+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


class Edit(NamedTuple):
    """A code block of the page: a new file, or lines to change in an existing one."""

    kind: str
    path: str
    text: str


def examples() -> dict[str, list[Edit]]:
    """The blocks of each section by the title of the section."""
    sections = PAGE.read_text().split("\n## ")[1:]
    return {
        section.partition("\n")[0]: [Edit(*found) for found in _BLOCK.findall(section)]
        for section in sections
    }


def apply(edit: Edit, root: Path) -> None:
    """Make a block's change below ``root``; a changed or context line must be there."""
    path = root / edit.path
    if edit.kind != "diff":
        assert not path.exists(), f"{edit.path} exists already"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(edit.text)
        return
    lines, at = path.read_text().splitlines(), 0
    for change in edit.text.splitlines():
        sign, line = change[:1], change[1:]
        if sign == "+":
            lines.insert(at, line)
            at += 1
            continue
        assert line in lines[at:], f"{edit.path} has no line {line!r} from line {at + 1} on"
        at = lines.index(line, at)
        if sign == "-":
            del lines[at]
        else:
            at += 1
    path.write_text("\n".join(lines) + "\n")


@pytest.fixture(scope="module")
def extended(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A copy of the sources with all worked examples applied."""
    root = tmp_path_factory.mktemp("extended")
    shutil.copytree(ROOT / SOURCES, root / SOURCES, ignore=shutil.ignore_patterns("__pycache__"))
    for edits in examples().values():
        for edit in edits:
            apply(edit, root)
    yield root
    shutil.rmtree(root)


def test_every_edit_fits(extended: Path) -> None:
    """The sources are still as the examples show them."""
    assert all((extended / edit.path).is_file() for edits in examples().values() for edit in edits)


def run(extended: Path, *arguments: object) -> str:
    """Standard output of the command line made from the extended sources."""
    paths = sorted(str(path) for path in (extended / SOURCES).iterdir())
    code = (
        f"import sys; sys.path[:0] = {paths!r}; from furuta_bringup.main import main; "
        f"sys.argv = ['furuta', *{[str(each) for each in arguments]!r}]; main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=extended
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def simulate(extended: Path, *arguments: object) -> dict[str, float]:
    """Ten seconds of simulation with the extended sources."""
    result: dict[str, float] = json.loads(
        run(extended, "simulate", "--seconds", 10, "--json", *arguments)
    )
    return result


@pytest.mark.long
def test_friction_law(extended: Path) -> None:
    """The new law is in the plant, in the exact limit cycle and in the describing function."""
    law = ("--set", "plant.friction.law=rational")
    simulated = simulate(extended, "--ideal-sensors", *law)["phi_peak_to_peak_rad"]
    exact = json.loads(run(extended, "limit-cycle", "--law", "rational", "--json"))
    assert simulated == pytest.approx(exact["phi_peak_to_peak_rad"], rel=0.02)
    predicted = json.loads(run(extended, "limit-cycle", "--predict", "--law", "rational", "--json"))
    (cycle,) = predicted["cycles"]
    assert cycle["phi_peak_to_peak_rad"] == pytest.approx(0.64, abs=0.05)


@pytest.mark.long
def test_compensator(extended: Path) -> None:
    """The new compensation works, and its parameter acts."""
    sharp, soft = (
        simulate(extended, "--compensation", "smooth", "--set", f"smooth.width={width}")
        for width in (0.02, 1.0)
    )
    assert sharp["phi_peak_to_peak_rad"] < 0.1 < soft["phi_peak_to_peak_rad"]


@pytest.mark.long
def test_estimator(extended: Path) -> None:
    """The new method holds the pendulum, also with a compensation that observes the friction."""
    method = ("--set", "estimator.method=differences")
    for compensation in ("none", "adaptive"):
        assert not simulate(extended, *method, "--compensation", compensation)["fell"]


@pytest.mark.long
def test_controller_mode(extended: Path) -> None:
    """Without friction the new mode brings the arm to rest, and mode off does not."""
    start = ("--set", "theta=3.0", "--set", "phi_dot=5.0", "--set", "alpha0=0", "--set", "alpha1=0")
    braked, free = (
        simulate(extended, "--set", f"mode={mode}", *start)["phi_peak_to_peak_rad"]
        for mode in ("brake", "off")
    )
    assert braked < 0.1
    assert free > 5.0


@pytest.mark.long
def test_rig(extended: Path) -> None:
    """The new rig is found and has its own model."""
    rig = extended / "furuta_ws" / "config" / "rigs" / "my_rig.yaml"
    shown = json.loads(run(extended, "hw", "rig", rig, "--json"))
    assert (shown["a23"], shown["sample_time"]) == (pytest.approx(-9.5), 0.002)


@pytest.mark.long
def test_verb(extended: Path) -> None:
    """The new verb is in the table and does what it says."""
    assert "The controller's gain L." in run(extended, "--help")
    gain = json.loads(run(extended, "gain", "--set", "omega1=10"))["L"]
    assert gain == json.loads(run(extended, "linearize", "--set", "omega1=10", "--json"))["L"]
