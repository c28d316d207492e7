"""Where the sources of the workspace are, and what each file of them imports."""

import ast
import importlib.util
import os
import xml.etree.ElementTree as ET
from configparser import ConfigParser
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ROOT / "furuta_ws" / "src"
TESTS = ROOT / "furuta_ws" / "tests"
# The scripts that make the documentation site, which tests import.
SITE = ROOT / "docs" / "site"
# Recordings of real rigs, which are not part of the project.
RECORDINGS = Path(os.environ.get("FURUTA_RECORDINGS", ROOT.parent / "shared" / "data"))
PACKAGES = sorted(path.name for path in SOURCES.iterdir())


def modules(package: str) -> list[Path]:
    """The modules of a package."""
    return sorted((SOURCES / package / package).rglob("*.py"))


def loaded(file: Path) -> ModuleType:
    """A Python file that is in no package, as a new module."""
    spec = importlib.util.spec_from_file_location(file.stem, file)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@cache
def imports(file: Path) -> set[str]:
    """Top-level names of the packages that a file imports."""
    names = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            names.add(node.module.partition(".")[0])
    return names


def manifest(package: str) -> ET.Element:
    """The package.xml of a package."""
    return ET.parse(SOURCES / package / "package.xml").getroot()


def keys(package: str, *tags: str) -> set[str]:
    """The dependencies that a package.xml declares with these tags."""
    return {element.text or "" for tag in tags for element in manifest(package).findall(tag)}


def product_requirements() -> list[str]:
    """What the product requires according to pyproject.toml, with its extras."""
    tomllib = pytest.importorskip("tomllib", reason="since Python 3.11")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    groups = (project["dependencies"], *project["optional-dependencies"].values())
    return [each for group in groups for each in group]


def setup_options(package: str) -> ConfigParser:
    """The setup.cfg of a package."""
    options = ConfigParser()
    options.read(SOURCES / package / "setup.cfg")
    return options
