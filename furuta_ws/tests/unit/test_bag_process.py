"""The process that writes bags: nothing is lost on the way, and nobody waits for it."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import pytest

from furuta_model.parameters import ParameterError
from furuta_recordings.bags import writer_process as bag_process
from furuta_recordings.bags.bag import Bag
from furuta_recordings.bags.mcap_file import Kind
from furuta_recordings.bags.writer_process import BagProcess

KINDS = [Kind("/a", "std_msgs/msg/Float64", "float64 data\n", "")]
MEGABYTE = bytes(2**20)


@pytest.fixture
def bag(tmp_path: Path) -> Iterator[BagProcess]:
    """A bag being written."""
    bag = BagProcess(tmp_path / "bag", KINDS, {"parameters.yaml": "plant: {}\n"})
    yield bag
    bag.close()


def writer_of(bag: BagProcess) -> int:
    return bag._process.pid


def test_what_goes_in_comes_out(bag: BagProcess, tmp_path: Path) -> None:
    """In order, whatever the sizes, and the bag is there from the start."""
    assert (tmp_path / "bag" / "parameters.yaml").read_text() == "plant: {}\n"
    contents = [os.urandom(size) for size in (0, 1, 70_000, 3_000_000, 12)]
    for time, content in enumerate(contents):
        bag.add(0, time, content)
        bag.send(wait=time % 2 == 0)
    bag.close()
    assert bag.failure is None
    with Bag(tmp_path / "bag") as reader:
        got = [(time, bytes(data)) for _, time, data in reader.messages()]
    assert got == list(enumerate(contents))


def test_nobody_waits_for_a_writer_that_stands_still(bag: BagProcess, monkeypatch: Any) -> None:
    """Handing over returns at once, until more waits than is allowed: then recording ends."""
    monkeypatch.setattr(bag_process, "LONGEST_WAIT", 4 * 2**20)
    os.kill(writer_of(bag), signal.SIGSTOP)
    for time in range(4):
        bag.add(0, time, MEGABYTE)
        bag.send()
        assert bag.failure is None
    for time in range(2):
        bag.add(0, time, MEGABYTE)
        bag.send()
    assert bag.failure is not None
    assert "does not keep up" in bag.failure
    os.kill(writer_of(bag), signal.SIGCONT)


def test_a_writer_that_is_killed(bag: BagProcess) -> None:
    """It is said, and handing over raises nothing."""
    os.kill(writer_of(bag), signal.SIGKILL)
    deadline = monotonic() + 30.0
    while bag.failure is None:
        assert monotonic() < deadline
        bag.add(0, 0, b"data")
        bag.send()
        sleep(0.01)
    assert "was ended" in bag.failure


def test_a_bag_that_cannot_be_made(tmp_path: Path) -> None:
    """The reason comes from the other process, in one line."""
    (tmp_path / "file").write_text("not a directory")
    for path, reason in (
        (tmp_path, "exists already"),
        (tmp_path / "file" / "bag", "file: File exists"),
    ):
        with pytest.raises(ParameterError, match=reason) as refused:
            BagProcess(path, KINDS, {})
        assert "\n" not in str(refused.value)
