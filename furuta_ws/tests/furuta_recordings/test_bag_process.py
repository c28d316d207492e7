"""The process that writes bags: no message is lost, and the recorder never waits for it."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import pytest

from furuta_model.parameters import ParameterError
from furuta_recordings.bags import background_writer
from furuta_recordings.bags.background_writer import BackgroundWriter
from furuta_recordings.bags.bag import Bag
from furuta_recordings.bags.metadata import BagTopic

TOPICS = [BagTopic("/a", "std_msgs/msg/Float64", "float64 data\n", "")]
MEGABYTE = bytes(2**20)


@pytest.fixture
def writer(tmp_path: Path) -> Iterator[BackgroundWriter]:
    """A bag being written."""
    writer = BackgroundWriter(tmp_path / "bag", TOPICS, {"parameters.yaml": "plant: {}\n"})
    yield writer
    writer.close()


def process_of(writer: BackgroundWriter) -> int:
    return writer._process.pid


def stop(pid: int) -> None:
    """Stop a process and wait until it is stopped."""
    os.kill(pid, signal.SIGSTOP)
    deadline = monotonic() + 30.0
    while Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "T":
        assert monotonic() < deadline
        sleep(0.001)


def test_all_messages_are_written(writer: BackgroundWriter, tmp_path: Path) -> None:
    """In order, whatever their sizes; the bag exists from the start."""
    assert (tmp_path / "bag" / "parameters.yaml").read_text() == "plant: {}\n"
    contents = [os.urandom(size) for size in (0, 1, 70_000, 3_000_000, 12)]
    for time, content in enumerate(contents):
        writer.add(0, time, content)
        writer.send(wait=time % 2 == 0)
    writer.close()
    assert writer.failure is None
    with Bag(tmp_path / "bag") as bag:
        got = [(time, bytes(data)) for _, time, data in bag.messages()]
    assert got == list(enumerate(contents))


def test_the_recorder_does_not_wait_for_a_stopped_writer(
    writer: BackgroundWriter, monkeypatch: Any
) -> None:
    """Sending returns until the backlog exceeds its limit; then recording ends."""
    monkeypatch.setattr(background_writer, "LARGEST_BACKLOG", 4 * 2**20)
    stop(process_of(writer))
    for time in range(4):
        writer.add(0, time, MEGABYTE)
        writer.send()
        assert writer.failure is None
    for time in range(2):
        writer.add(0, time, MEGABYTE)
        writer.send()
    assert writer.failure is not None
    assert "the disk is too slow" in writer.failure
    os.kill(process_of(writer), signal.SIGCONT)


def test_a_killed_writer_is_reported(writer: BackgroundWriter) -> None:
    """Sending does not raise; the failure says what happened."""
    os.kill(process_of(writer), signal.SIGKILL)
    deadline = monotonic() + 30.0
    while writer.failure is None:
        assert monotonic() < deadline
        writer.add(0, 0, b"data")
        writer.send()
        sleep(0.01)
    assert "was killed" in writer.failure


def test_a_bag_that_cannot_be_created(tmp_path: Path) -> None:
    """The reason comes from the other process, in one line."""
    (tmp_path / "file").write_text("not a directory")
    for path, reason in (
        (tmp_path, "already exists"),
        (tmp_path / "file" / "bag", "file: File exists"),
    ):
        with pytest.raises(ParameterError, match=reason) as error:
            BackgroundWriter(path, TOPICS, {})
        assert "\n" not in str(error.value)
