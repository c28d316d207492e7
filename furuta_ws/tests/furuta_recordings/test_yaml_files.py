"""YAML within bounds: what is rejected, where, and what is not."""

from pathlib import Path

import pytest
import yaml

from furuta_model.parameters import ParameterError
from furuta_ros.yaml_files import DEEPEST_NESTING, parse_yaml, read_yaml


@pytest.mark.parametrize(
    "text", ["a: {b: [1, 2.5, off, null]}", "[" * DEEPEST_NESTING + "]" * DEEPEST_NESTING]
)
def test_ordinary_text_is_read_as_before(text: str) -> None:
    assert parse_yaml(text, "file") == yaml.safe_load(text)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("[" * 200_000, f"nested deeper than {DEEPEST_NESTING} levels in line 1"),
        ("a: &x 1\nb: *x", r"\*x is an alias, write its value in line 2"),
        ("a: !!python/object/apply:os.getcwd []", ".* in line 1"),
        ("a: [1\n", ".* in line 2"),
        ("a: {b: 1, b: 2}", "b is given twice in line 1"),
    ],
)
def test_the_error_says_what_is_wrong_and_where(text: str, reason: str) -> None:
    with pytest.raises(ParameterError, match=f"^rig file x is not YAML: {reason}") as e:
        parse_yaml(text, "rig file x")
    assert "\n" not in str(e.value)


def test_what_cannot_be_read_is_one_line(tmp_path: Path) -> None:
    """Missing, a directory, without an end, or no text."""
    (tmp_path / "binary").write_bytes(b"\xff\xfe\0")
    for file, reason in (
        (tmp_path / "none", "No such file or directory"),
        (tmp_path, "Is a directory"),
        (Path("/dev/zero"), "larger than 2097152 bytes"),
        (tmp_path / "binary", "not a text file"),
    ):
        with pytest.raises(ParameterError, match=f"cannot read rig file {file}: {reason}"):
            read_yaml(file, "rig file")
