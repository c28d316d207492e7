"""YAML within bounds: what is rejected, where, and what is not."""

import os
from pathlib import Path

import hostile_files as hostile
import pytest
import yaml

from furuta_model.parameters import ParameterError
from furuta_ros import yaml_files
from furuta_ros.yaml_files import DEEPEST_NESTING, MOST_VALUES, parse_yaml, read_yaml


@pytest.mark.parametrize(
    "text",
    [
        "",
        "a: {b: [1, 2.5, off, null]}",
        "a: &x {b: 1}\nc: {<<: *x, d: [*x, *x]}",
        "[" * DEEPEST_NESTING + "]" * DEEPEST_NESTING,
        "notes: '" + "1" * 5000 + "'",
    ],
)
def test_ordinary_text_is_read_as_before(text: str) -> None:
    assert parse_yaml(text, "file") == yaml.safe_load(text)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (hostile.YAML["billion_laughs"], f"more than {MOST_VALUES} values, .* in line 6"),
        ("[" * (DEEPEST_NESTING + 1), f"nested deeper than {DEEPEST_NESTING} levels in line 1"),
        ("a: 1\nb: &b [{c: *b}]", r"\*b in line 2 contains itself"),
        ("a: 1\nb: *c", "not YAML: .*undefined alias in line 2"),
        ("a: 2020-99-99", "not YAML: month must be in 1..12"),
        ("a: !!int one", "not YAML"),
        ("a: !!int " + "1:" * 501 + "1", "a number of 1003 characters in line 1"),
        ("a: 0x" + "f" * 1000, "a number of 1002 characters in line 1"),
        ("a: !!python/object/apply:os.getcwd []", "not YAML: .* in line 1"),
        ("a: [1\n", "not YAML: .* in line 2"),
        ("a: {b: 1, b: 2}", "not YAML: b is given twice in line 1"),
    ],
)
def test_the_error_says_what_is_wrong_and_where(text: str, reason: str) -> None:
    with pytest.raises(ParameterError, match=f"^rig file x: {reason}|^rig file x is {reason}") as e:
        parse_yaml(text, "rig file x")
    assert "\n" not in str(e.value)


def test_the_bounds_hold_without_the_parser_in_c(monkeypatch: pytest.MonkeyPatch) -> None:
    """PyYAML may have been built without it."""
    monkeypatch.setattr(yaml_files, "_LOADER", yaml.SafeLoader)
    for name in ("billion_laughs", "itself", "number"):
        with pytest.raises(ParameterError):
            parse_yaml(hostile.YAML[name], "file")


def test_only_regular_files_are_read(tmp_path: Path) -> None:
    """Opening a pipe does not wait for a writer."""
    os.mkfifo(tmp_path / "pipe")
    for file, kind in ((tmp_path / "pipe", "a device or pipe"), (tmp_path, "a directory"),
                       (Path("/dev/zero"), "a device or pipe")):  # fmt: skip
        with pytest.raises(ParameterError, match=f"{file}: it is {kind}, not a regular file"):
            read_yaml(file, "rig file")
