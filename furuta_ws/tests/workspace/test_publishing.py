"""Workflows, container and hooks run scripts that exist, as the pages describe them."""

import json
import re
from pathlib import Path

import pytest
import yaml
from sources import ROOT

WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
HOOKS = ROOT / ".pre-commit-config.yaml"
CONTAINER = (ROOT / "Dockerfile", ROOT / ".devcontainer" / "devcontainer.json")


def scripts(text: str) -> set[str]:
    """The targets of make, and the files, that a file of commands names."""
    targets = re.findall(r"\bmake ([a-z][a-z-]*)$", text, re.MULTILINE)
    files = re.findall(r"(?:\.ci|tools|furuta_ws)/[\w./-]+", text)
    return {f"make {each}" for each in targets} | set(files)


@pytest.mark.parametrize("file", [*WORKFLOWS, HOOKS, *CONTAINER], ids=lambda file: file.name)
def test_what_is_run_exists(file: Path) -> None:
    """Targets of make, scripts, and the steps of the script for ROS."""
    targets = set(re.findall(r"^([a-z-]+(?: [a-z-]+)*):", (ROOT / "Makefile").read_text(), re.M))
    names = set(" ".join(targets).split())
    found = scripts(file.read_text())
    assert found
    for each in found - {"furuta_ws/install/setup.bash"}:
        kind, _, name = each.partition(" ")
        assert name in names if kind == "make" else (ROOT / each).exists(), each
    steps = re.findall(r"^(\w+)\(\)", (ROOT / ".ci" / "jazzy").read_text(), re.MULTILINE)
    for called in re.findall(r"\.ci/jazzy((?: [a-z]+)+)", file.read_text()):
        assert set(called.split()) - {"rm"} <= set(steps), called


def test_container_builds_as_readme_says() -> None:
    """The commands where ROS is installed are those of the script."""
    script = (ROOT / ".ci" / "jazzy").read_text()
    section = (ROOT / "README.md").read_text().partition("Where ROS 2 Jazzy is installed:")[2]
    commands = re.findall(r"^    (.*?)(?: +#.*)?$", section.partition("\n\n")[2], re.MULTILINE)
    installed = [each for each in commands if "install " in each and "source" not in each]
    assert len(installed) == 2
    assert all(each in script for each in installed)


def test_files_are_well_formed() -> None:
    """Every workflow limits what its token may do; the container is built from the one file."""
    for file in WORKFLOWS:
        assert yaml.safe_load(file.read_text())["permissions"] == {"contents": "read"}, file
    build = json.loads(CONTAINER[1].read_text())["build"]
    assert (CONTAINER[1].parent / build["dockerfile"]).resolve() == CONTAINER[0]
    assert f"AS {build['target']}\n" in CONTAINER[0].read_text()
