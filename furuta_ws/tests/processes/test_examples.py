"""Each example runs from an empty folder and prints what the comment at its end says."""

import re
import signal
import sys
from importlib.util import find_spec
from pathlib import Path
from shutil import which
from typing import Any

import numpy as np
import pytest
from paused_graph import PausedGraph
from sources import ROOT

from furuta_ros.testing import Bench
from furuta_ros.topics import COMMAND

EXAMPLES = {file.stem: file for file in sorted((ROOT / "examples").glob("*.py"))}
NODE = EXAMPLES.pop("own_controller_node")  # does not end by itself
# What an example needs beside the library, and those that take long.
PACKAGES = {
    "bag_to_pandas": "pandas",
    "parallel_sweep": "distributed",
    "predicted_cycles": "control",
    "train_policy": "gymnasium",
}
LONG = ("parallel_sweep", "random_rigs", "train_policy")
# A picture with curves has more bytes than an empty one.
LEAST_BYTES = 20_000


def printed(example: Path) -> list[str]:
    """What the example says that it prints."""
    comment = example.read_text().partition("\n# prints\n")[2]
    assert comment, f"{example.name} does not say what it prints"
    return [line.removeprefix("#").removeprefix(" ") for line in comment.splitlines()]


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.long] * (n in LONG)) for n in EXAMPLES]
)
def test_example(name: str, processes: Any, tmp_path: Path, monkeypatch: Any) -> None:
    """It prints what it says, and draws the picture that it names."""
    needed = PACKAGES.get(name)
    if needed and find_spec(needed) is None:
        pytest.skip(f"{needed} is not installed")
    if name == "export_c" and which("cc") is None:
        pytest.skip("there is no C compiler")
    monkeypatch.chdir(tmp_path)
    process = processes.start(sys.executable, EXAMPLES[name])
    out, err = process.communicate(timeout=240)
    assert process.returncode == 0, err
    assert [line.rstrip() for line in out.splitlines()] == printed(EXAMPLES[name])
    for picture in set(re.findall(r"output/examples/\w+\.png", EXAMPLES[name].read_text())):
        assert (tmp_path / picture).stat().st_size > LEAST_BYTES


def test_own_controller(bench: Bench, processes: Any) -> None:
    """The example in place of our controller holds the pendulum upright, and ends by Ctrl-C."""
    graph = PausedGraph(bench)
    processes.furuta("run", "--lockstep", "--without", "controller", "--set", "run_until=0")
    example = processes.start(sys.executable, NODE)
    commands = bench.collect(COMMAND)
    states = graph.run(2000)
    bench.spin(lambda: len(commands) >= 2000, timeout=60.0)
    assert np.abs(states[:, 2]).max() < 0.1
    assert np.abs(states[1000:, 2]).max() < 0.03 < states[0, 2]
    assert np.ptp(states[:, 0]) > 0.05  # the arm moves: the pendulum is not held
    example.send_signal(signal.SIGINT)
    out, err = example.communicate(timeout=60)
    assert "Traceback" not in err
    assert out.splitlines() == printed(NODE)
    assert example.returncode == 0
