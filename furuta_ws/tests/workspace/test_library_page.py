"""The page on the library lists what there is."""

import re

import pytest
from sources import ROOT

import furuta

PAGE = (ROOT / "docs" / "library.md").read_text()


def test_library_page_has_every_name() -> None:
    """And names nothing else."""
    listed = re.search(r"## What there is\n(.*?)\n## ", PAGE, re.DOTALL)
    assert listed is not None
    assert {*re.findall(r"`(\w+)`", listed[1])} == {*furuta.__all__} - {"__version__"}


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_examples_run(number: int) -> None:
    """The examples that need no file; the others only name functions that exist."""
    blocks = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    if "gymnasium" in blocks[number]:
        pytest.importorskip("gymnasium")
    exec("import furuta\n" + blocks[number].replace("60.0", "1.0"), {})
    assert set(re.findall(r"furuta\.(\w+)", PAGE)) <= {"gym", *dir(furuta)}
