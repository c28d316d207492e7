"""Parameter files are the declarations of the parameters."""

from pathlib import Path
from typing import Annotated, Any, NamedTuple

import pytest

from furuta_bringup.parameter_files import parameter_file
from furuta_graph.settings.nodes import NODES, NodeDescription
from furuta_graph.settings.settings import read_file
from furuta_model.parameters import About, declared


@pytest.fixture
def file(tmp_path: Path) -> Any:
    """Writes a parameter file."""

    def write(text: str, name: str = "rig.yaml") -> Path:
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


@pytest.mark.parametrize("node", NODES)
def test_default_files_say_the_defaults(file: Any, node: str) -> None:
    """The generated file holds every parameter, each with its default's value and type."""
    given = read_file(file(parameter_file(node)))[node]
    parameters = declared(NODES[node].parameters)
    assert given == {parameter.name: parameter.default for parameter in parameters}
    assert all(type(given[parameter.name]) is type(parameter.default) for parameter in parameters)


class Tiny(NamedTuple):
    """Defaults that YAML 1.1 would take for text if written as Python does."""

    small: Annotated[float, About("small")] = 1e-05
    large: Annotated[float, About("large")] = -2e22


def test_small_and_large_defaults(file: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Numbers with an exponent are written so that they are read as numbers."""
    monkeypatch.setitem(NODES, "tiny", NodeDescription("tiny", f"{__name__}:Tiny", "m:C"))
    assert read_file(file(parameter_file("tiny")))["tiny"] == {"small": 1e-5, "large": -2e22}
