"""The page on the library lists what there is."""

import inspect
import re
from collections.abc import Iterator

import pytest
from sources import ROOT

import furuta

PAGE = (ROOT / "docs" / "library.md").read_text()


def rows() -> Iterator[str]:
    """A row of the page for each class and function."""
    for name in furuta.__all__:
        thing = getattr(furuta, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            summary = (thing.__doc__ or "").splitlines()[0].rstrip(".").replace("``", "`")
            yield f"| `{name}` | {summary} |"


def test_library_page_has_every_name() -> None:
    """With the first line of its docstring, and nothing else."""
    assert {*rows(), "| `COLUMNS` | Unit and meaning of each column, by name |"} == {
        line for line in PAGE.splitlines() if line.startswith("| `")
    }


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_examples_run(number: int) -> None:
    """The examples that need no file; the others only name functions that exist."""
    blocks = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    exec("import furuta\n" + blocks[number].replace("60.0", "1.0"), {})
    assert set(re.findall(r"furuta\.(\w+)", PAGE)) <= {"gym", *dir(furuta)}
