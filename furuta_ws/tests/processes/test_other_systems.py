"""On Windows and macOS, as far as Linux can show it: the verbs that need no ROS work."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from joint_bags import joint_bag
from rosbags.rosbag2 import StoragePlugin
from sources import TESTS

# What uses all cores, which macOS and Windows count otherwise; and all other verbs.
ON_ALL_CORES = """limit-cycle --over omega1=6:7:2; swing-up --starts 1
sweep alpha0=0.1:0.3:3 --seconds 1 --out sweep.csv"""
OTHERS = """--help; axis --help; simulate --seconds 2 --out run.csv; linearize --figure n.png
limit-cycle; limit-cycle --predict; axis --inertia 1 --friction alpha0=1 --pid 100 100 20
export c --out c; bag info bag; bag export run.csv --out run.mat; bag recover bag; param defaults
hw rig paper; compare --rigs 2 --candidate none --seconds 5"""
NEED_ROS = """run; demo; view; view --attach; param get plant alpha0; hw arm; hw emulate
bag replay bag; tune --running"""


@pytest.mark.parametrize(
    ("platform", "ros", "verbs", "reason"),
    [
        ("darwin", "without", ON_ALL_CORES, ""),
        ("win32", "without", f"{ON_ALL_CORES}; {OTHERS}", ""),
        ("win32", "without", NEED_ROS, "is not installed: ROS 2 Jazzy, or on Linux"),
        ("win32", "with", "run; view --no-open; view --attach", "needs Linux, whose Python has"),
    ],
)
def test_verbs_without_what_only_linux_has(
    platform: str, ros: str, verbs: str, reason: str, tmp_path: Path
) -> None:
    """In one process: each works, or says in one line what it needs."""
    messages = [(k * 10**7, k * 10**7, {"elbow": (0.1 * k, 0.0, 1.0)}) for k in range(1, 100)]
    joint_bag(tmp_path / "bag", messages, StoragePlugin.MCAP)
    given = verbs.replace("\n", "; ").split("; ")
    statuses, lines = run(platform, ros, given, tmp_path)
    assert statuses == dict.fromkeys(given, int(bool(reason))), lines
    errors = [line for line in lines if line.startswith("error: ")]
    assert len(errors) == len(given) * bool(reason)
    assert all(reason in line for line in errors)


def run(
    platform: str, ros: str, verbs: list[str], folder: Path
) -> tuple[dict[str, object], list[str]]:
    """The exit status of each verb, and all other lines on standard error."""
    script = [sys.executable, "-X", "warn_default_encoding", str(TESTS / "other_systems.py")]
    arguments = json.dumps([verb.split() for verb in verbs])
    done = subprocess.run(
        [*script, platform, ros, arguments], cwd=folder, capture_output=True, text=True, check=True
    )
    lines = done.stderr.splitlines()
    found = dict(json.loads(line) for line in lines if line.startswith('["'))
    return found, [line for line in lines if not line.startswith('["')]
