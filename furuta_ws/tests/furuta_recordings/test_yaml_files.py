"""YAML within bounds: what is rejected, where, and what is not."""

import os
from pathlib import Path

import pytest
import yaml

from furuta_model.parameters import ParameterError
from furuta_ros.yaml_files import DEEPEST_NESTING, parse_yaml, read_yaml


@pytest.mark.parametrize(
    "text",
    [
        "",
        "a: {b: [1, 2.5, off, null]}",
        "[" * DEEPEST_NESTING + "]" * DEEPEST_NESTING,
        "notes: '" + "1" * 5000 + "'",
    ],
)
def test_ordinary_text_is_read_as_before(text: str) -> None:
    assert parse_yaml(text, "file") == yaml.safe_load(text)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("[" * 200_000, f"nested deeper than {DEEPEST_NESTING} levels in line 1"),
        ("a: &x 1\nb: *x", r"\*x is an alias, write its value in line 2"),
        ("a: 2020-99-99", "month must be in 1..12"),
        ("a: !!int one", ""),
        ("a: !!int ''", ""),
        ("a: !!bool maybe", ""),
        ("a: !!timestamp soon", ""),
        ("a: " + "1:" * 501 + "1", "a number of 1003 characters in line 1"),
        ("a: 0x" + "f" * 1000, "a number of 1002 characters in line 1"),
        ("a: !!python/object/apply:os.getcwd []", ".* in line 1"),
        ("a: [1\n", ".* in line 2"),
        ("? [a]\n: 1", "found unhashable key in line 1"),
        ("a: {b: 1, b: 2}", "b is given twice in line 1"),
    ],
)
def test_the_error_says_what_is_wrong_and_where(text: str, reason: str) -> None:
    with pytest.raises(ParameterError, match=f"^rig file x is not YAML: {reason}") as e:
        parse_yaml(text, "rig file x")
    assert "\n" not in str(e.value)


def test_only_regular_files_are_read(tmp_path: Path) -> None:
    """Opening a pipe does not wait for a writer."""
    os.mkfifo(tmp_path / "pipe")
    for file, kind in ((tmp_path / "pipe", "a device or pipe"), (tmp_path, "a directory"),
                       (Path("/dev/zero"), "a device or pipe")):  # fmt: skip
        with pytest.raises(ParameterError, match=f"{file}: it is {kind}, not a regular file"):
            read_yaml(file, "rig file")
