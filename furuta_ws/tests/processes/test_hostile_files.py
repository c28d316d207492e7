"""Hostile files: one line, little memory and time, and nothing outside the bag opened."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import hostile_files as hostile
import limited_verbs
import pytest

# Longest time [s] that a refusal may take on a busy machine.
LONGEST = 60.0
Make = Callable[[Path], Path]

BAGS: dict[str, tuple[Make, str]] = {
    "parent_path": (hostile.parent_path, "outside the bag"),
    "linked_file": (hostile.linked_file, "is a link to a file outside the bag"),
    "escaped_name": (hostile.escaped_name, "must not contain %"),
    "pipe_as_data": (hostile.pipe_as_data, "is not a regular file"),
    "zstd_bomb": (hostile.bomb("zstd", 2**31), "claims to hold 2147483648 bytes"),
    "zstd_liar": (hostile.bomb("zstd", 2**31, 2**20), "not hold the 1048576 bytes"),
    "long_record": (hostile.file_of(hostile.long_record), "a record claims 1000000000 bytes"),
    "endless_view": (hostile.endless_view, "messages is not a plain table"),
    "claimed_array": (hostile.claimed_array, "Invalid sequence length 1000000000"),
    "fixed_array": (hostile.fixed_array, "1000000000 elements"),
    "metadata": (hostile.metadata_of("a: &a 1\nb: *a\n"), "is an alias"),
}
# What is wrong with these is noticed only where their chunks are read.
UNREAD = {"zstd_bomb", "zstd_liar", "long_record"}
# These are read or copied without what makes them hostile.
HARMLESS = {
    "info": {"claimed_array", "fixed_array", *UNREAD},
}


def run_limited(directory: Path, calls: list[list[str]]) -> list[dict[str, Any]]:
    """Run verbs with little memory; the reports on all calls."""
    file = directory / "calls.json"
    file.write_text(json.dumps(calls))
    done = subprocess.run(
        [sys.executable, limited_verbs.__file__, str(file)],
        cwd=directory, capture_output=True, text=True, check=False,
        timeout=LONGEST * len(calls),
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-3000:]
    return list(json.loads(done.stdout.splitlines()[-1]))


def assert_refused(report: dict[str, Any], reason: str) -> None:
    """One line that says why, in a bounded time, without opening what is outside."""
    lines = report["err"].splitlines()
    assert report["status"] == 1, report
    assert len(lines) == 1, report["err"][-2000:]
    assert lines[0].startswith("error: ")
    assert reason in lines[0]
    assert "MemoryError" not in lines[0]
    assert len(lines[0]) < 2500
    assert report["seconds"] < LONGEST
    assert_nothing_outside(report)


def assert_nothing_outside(report: dict[str, Any]) -> None:
    opened = [os.path.realpath(path) for path in report["opened"]]
    assert not [path for path in opened if f"/{hostile.SECRET}" in path]


def assert_copes(report: dict[str, Any]) -> None:
    """Done, or refused with one line, in a bounded time."""
    assert report["status"] in (0, 1), report
    assert len(report["err"].splitlines()) == report["status"], report["err"][-2000:]
    assert report["seconds"] < LONGEST
    assert_nothing_outside(report)


def _directory(tmp_path: Path, name: str) -> Path:
    directory = tmp_path / name
    directory.mkdir()
    return directory


def _content(directory: Path) -> dict[str, int]:
    """Every file with the time of its last change."""
    return {str(file): file.lstat().st_mtime_ns for file in directory.rglob("*")}


@pytest.mark.parametrize(
    ("names", "verb"),
    [
        (tuple(BAGS), ("bag", "info")),
        pytest.param(
            ("parent_path", "linked_file", "pipe_as_data", "claimed_array", "fixed_array"),
            ("identify",),
            marks=pytest.mark.long,
        ),
        pytest.param(
            ("linked_file", "zstd_liar"),
            ("bag", "replay", "--rate", "0"),
            marks=pytest.mark.long,
        ),
    ],
)
def test_hostile_bags_are_not_read(
    tmp_path: Path, names: tuple[str, ...], verb: tuple[str, ...]
) -> None:
    bags = [BAGS[name][0](_directory(tmp_path, name) / "bag") for name in names]
    sound = hostile.sound_bag(tmp_path / "sound")
    before = _content(tmp_path)
    reports = run_limited(tmp_path, [[*verb, str(bag)] for bag in (sound, *bags)])[1:]
    for name, report in zip(names, reports, strict=True):
        print(name, f"{report['seconds']:.2f} s", report["err"].strip())
        if name in HARMLESS.get(verb[-1], set()):
            assert_copes(report)
        else:
            assert_refused(report, BAGS[name][1])
    (tmp_path / "calls.json").unlink()
    assert _content(tmp_path) == before


def test_hostile_bags_are_recovered_within_bounds(tmp_path: Path) -> None:
    """``bag recover`` copies what is sound and names the rest; it follows no link."""
    names = list(BAGS)
    bags = [BAGS[name][0](_directory(tmp_path, name) / "bag") for name in names]
    sound = hostile.sound_bag(tmp_path / "sound")
    reports = run_limited(tmp_path, [["bag", "recover", str(bag)] for bag in (sound, *bags)])[1:]
    for name, report in zip(names, reports, strict=True):
        print(name, report["status"], f"{report['seconds']:.2f} s", report["err"].strip())
        assert_copes(report)
        written = [path for path in (tmp_path / name).rglob("*") if "recovered" in str(path)]
        assert sum(path.stat().st_size for path in written) < 2**20


def test_a_recovery_writes_through_no_link(tmp_path: Path) -> None:
    """Neither the new bag nor its temporary directory may be a link."""
    bag, outside = hostile.sound_bag(tmp_path / "bag"), tmp_path / hostile.SECRET
    outside.mkdir()
    for name in ("link", ".new_bag.new"):
        (tmp_path / name).symlink_to(outside)
    (tmp_path / "dangling").symlink_to(tmp_path / "nothing")
    outs = ("link", "dangling", "new_bag")
    calls = [["bag", "recover", str(bag), "--out", str(tmp_path / out)] for out in outs]
    for report in run_limited(tmp_path, calls):
        assert (report["status"], len(report["err"].splitlines())) == (1, 1), report
    assert not list(outside.iterdir())
    assert not (tmp_path / "nothing").exists()
