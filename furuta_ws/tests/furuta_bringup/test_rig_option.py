"""The option --rig of the verbs that have model parameters."""

from pathlib import Path

import click
from click.testing import CliRunner

from furuta_bringup.options import model_options


def test_the_rig_is_the_first_parameter_file(tmp_path: Path) -> None:

    @click.command()
    @model_options
    def verb(files: tuple[Path, ...], assignments: tuple[str, ...]) -> None:
        print([file.name for file in files], assignments)

    rig, other = tmp_path / "mine.yaml", tmp_path / "other.yaml"
    rig.write_text("name: mine")
    arguments = ["--params", str(other), "--rig", str(rig), "--set", "a=1"]
    result = CliRunner().invoke(verb, arguments)
    assert result.output == "['mine.yaml', 'other.yaml'] ('a=1',)\n"
