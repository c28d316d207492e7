"""The option --rig of the verbs that have model parameters."""

from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from furuta_bringup.main import VERBS
from furuta_bringup.options import model_options


def commands(command: click.Command) -> Iterator[click.Command]:
    """The command, and those of a group."""
    yield command
    if isinstance(command, click.Group):
        for inner in command.commands.values():
            yield from commands(inner)


@pytest.mark.parametrize("verb", VERBS)
def test_who_takes_parameter_files_takes_a_rig(verb: str) -> None:
    """So that a rig is the same rig everywhere."""
    module = import_module(f"furuta_bringup.verbs.{verb.replace('-', '_')}")
    for command in commands(module.command):
        names = {parameter.name for parameter in command.params}
        assert "files" not in names or "rig" in names, command.name


def test_the_rig_is_the_first_parameter_file(tmp_path: Path) -> None:

    @click.command()
    @model_options
    def verb(files: tuple[Path, ...], assignments: tuple[str, ...]) -> None:
        print([file.name for file in files], assignments)

    rig, other = tmp_path / "mine.yaml", tmp_path / "other.yaml"
    arguments = ["--params", str(other), "--rig", str(rig), "--set", "a=1"]
    result = CliRunner().invoke(verb, arguments)
    assert result.output == "['mine.yaml', 'other.yaml'] ('a=1',)\n"
