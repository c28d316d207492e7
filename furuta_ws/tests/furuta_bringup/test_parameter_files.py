"""Parameter files and the option --rig."""

from pathlib import Path
from typing import Annotated, NamedTuple

import click
import pytest
from click.testing import CliRunner

from furuta_bringup.options import model_options
from furuta_bringup.parameter_files import parameter_file
from furuta_graph.settings.nodes import NODES, NodeDescription
from furuta_graph.settings.settings import read_file
from furuta_model.parameters import About


class Tiny(NamedTuple):
    """Defaults that YAML 1.1 would take for text if written as Python does."""

    small: Annotated[float, About("small")] = 1e-05
    large: Annotated[float, About("large")] = -2e22


def test_small_and_large_defaults(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Numbers with an exponent are written so that they are read as numbers."""
    monkeypatch.setitem(NODES, "tiny", NodeDescription("tiny", f"{__name__}:Tiny", "m:C"))
    file = tmp_path / "tiny.yaml"
    file.write_text(parameter_file("tiny"))
    assert read_file(file)["tiny"] == {"small": 1e-5, "large": -2e22}


def test_the_rig_is_the_first_parameter_file(tmp_path: Path) -> None:

    @click.command()
    @model_options
    def verb(files: tuple[Path, ...], assignments: tuple[str, ...]) -> None:
        print([file.name for file in files], assignments)

    rig, other = tmp_path / "mine.yaml", tmp_path / "other.yaml"
    arguments = ["--params", str(other), "--rig", str(rig), "--set", "a=1"]
    result = CliRunner().invoke(verb, arguments)
    assert result.output == "['mine.yaml', 'other.yaml'] ('a=1',)\n"
