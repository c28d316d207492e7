"""Bags that survive: every moment of writing leaves a bag that other libraries read."""

from __future__ import annotations

import errno
import os
import random
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from time import sleep
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from furuta_model.parameters import ParameterError
from furuta_recordings.bags import mcap_file
from furuta_recordings.bags.bag import Bag, refuse_too_long
from furuta_recordings.bags.mcap_file import Kind
from furuta_recordings.bags.recovery import recover
from furuta_recordings.bags.writer import BagWriter

KINDS = [
    Kind("/a", "std_msgs/msg/Float64", "float64 data\n", ""),
    Kind("/b", "std_msgs/msg/Float64", "float64 data\n", ""),
]
# A Float64 in CDR: header, then eight bytes.
DATA = b"\x00\x01\x00\x00" + bytes(8)
WRITE_FOR_EVER = """
import itertools, sys, time
from pathlib import Path
from furuta_recordings.bags.writer import BagWriter
from furuta_recordings.bags.mcap_file import Kind
kinds = [Kind("/a", "std_msgs/msg/Float64", "float64 data\\n", "")]
writer = BagWriter(Path(sys.argv[1]), kinds, {"parameters.yaml": "plant: {}"})
for k in itertools.count():
    writer.add(0, k, b"\\x00\\x01\\x00\\x00" + k.to_bytes(8, "little"))
    if k % 50 == 0:
        writer.flush()
        print(k, flush=True)
"""


def counts(bag: Path) -> tuple[int, int]:
    """Messages that rosbags and the mcap library read."""
    with AnyReader([bag]) as reader:
        by_rosbags = sum(1 for _ in reader.messages())
        assert reader.message_count <= by_rosbags
    by_mcap = 0
    for file in bag.glob("*.mcap"):
        with file.open("rb") as stream:
            by_mcap += sum(1 for _ in make_reader(stream).iter_messages())
    return by_rosbags, by_mcap


def test_a_bag_is_whole_after_every_flush(tmp_path: Path) -> None:
    """Before it is closed, and closed; the room that was not used goes."""
    writer = BagWriter(tmp_path / "bag", KINDS, {"parameters.yaml": "plant: {}\n"})
    assert counts(writer.path) == (0, 0)
    for k in range(5):
        for j in range(10):
            writer.add(j % 2, 10 * k + j, DATA)
        writer.flush()
        assert counts(writer.path) == (10 * k + 10, 10 * k + 10)
    writer.add(0, 99, DATA)
    writer.close()
    assert counts(writer.path) == (51, 51)
    (file,) = writer.path.glob("*.mcap")
    assert file.stat().st_size < 20_000
    assert (writer.path / "parameters.yaml").read_text() == "plant: {}\n"
    with Bag(writer.path) as reader:
        assert {c.topic: c.msgcount for c in reader.connections} == {"/a": 26, "/b": 25}
        assert [time for _, time, _ in reader.messages()][-1] == 99


def test_a_full_file_is_followed_by_another(tmp_path: Path, monkeypatch: Any) -> None:
    """As rosbag2 splits bags; order and number of messages stay."""
    monkeypatch.setattr(mcap_file, "DATA_ROOM", 2**20 + 10_000)
    writer = BagWriter(tmp_path / "bag", KINDS, {})
    for k in range(1000):
        writer.add(0, k, DATA)
        if k % 10 == 0:
            writer.flush()
    writer.close()
    assert len(list(writer.path.glob("*.mcap"))) > 2
    assert counts(writer.path) == (1000, 1000)


def test_sigkill_at_any_moment(tmp_path: Path) -> None:
    """Twelve writers killed while they write without pause: all that was flushed is there."""
    for k in range(12):
        bag = tmp_path / f"bag{k}"
        child = subprocess.Popen(
            [sys.executable, "-c", WRITE_FOR_EVER, str(bag)], stdout=subprocess.PIPE, text=True
        )
        assert child.stdout is not None
        child.stdout.readline()
        sleep(random.uniform(0.0, 0.1))
        child.send_signal(signal.SIGKILL)
        said = [int(line) for line in child.communicate()[0].splitlines() if line.endswith("\n")]
        by_rosbags, by_mcap = counts(bag)
        assert by_rosbags == by_mcap >= max(said, default=0)


def test_a_full_disk_keeps_what_came_before(tmp_path: Path, monkeypatch: Any) -> None:
    """Writing fails, and the bag still reads."""
    writer = BagWriter(tmp_path / "bag", KINDS, {})
    writer.add(0, 1, DATA)
    writer.flush()

    def full(*_: Any) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "pwrite", full)
    writer.add(0, 2, DATA)
    with pytest.raises(OSError, match="No space left"):
        writer.flush()
    monkeypatch.undo()
    assert counts(writer.path) == (1, 1)


def written(path: Path, chunks: int = 20) -> Path:
    writer = BagWriter(path, KINDS, {})
    for k in range(chunks):
        for j in range(50):
            writer.add(j % 2, 50 * k + j, DATA)
        writer.flush()
    writer.close()
    return path


@pytest.mark.parametrize("part", [0.3, 0.6, 0.95])
def test_recover_truncated(tmp_path: Path, part: float) -> None:
    """What lies before the cut comes back; the bag itself said that it was cut."""
    bag = written(tmp_path / "bag")
    (file,) = bag.glob("*.mcap")
    os.truncate(file, int(part * file.stat().st_size))
    with pytest.raises(ParameterError, match="no readable bag"), Bag(bag):
        pass
    result = recover(bag, tmp_path / "mended")
    assert 0.7 * part * 1000 < result["messages"] <= 1000
    assert counts(tmp_path / "mended") == (result["messages"], result["messages"])


def test_recover_corrupted(tmp_path: Path) -> None:
    """A damaged chunk is left out by its checksum, the others stay."""
    bag = written(tmp_path / "bag")
    (file,) = bag.glob("*.mcap")
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 0xFF
    file.write_bytes(content)
    result = recover(bag, tmp_path / "mended")
    assert result["messages"] in (950, 1000)
    assert counts(tmp_path / "mended")[0] == result["messages"]


def test_recover_without_metadata(tmp_path: Path) -> None:
    """A bag whose metadata.yaml is gone."""
    bag = written(tmp_path / "bag")
    (bag / "metadata.yaml").unlink()
    with pytest.raises(ParameterError, match="no readable bag"), Bag(bag):
        pass
    assert recover(bag, tmp_path / "mended")["messages"] == 1000


@pytest.mark.parametrize("plugin", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
def test_foreign_bags(tmp_path: Path, plugin: StoragePlugin) -> None:
    """Bags of another writer are read and recovered, sqlite3 and mcap."""
    types = get_typestore(Stores.ROS2_HUMBLE)
    with Writer(tmp_path / "bag", version=8, storage_plugin=plugin) as writer:
        connection = writer.add_connection("/a", "std_msgs/msg/Float64", typestore=types)
        for k in range(10):
            writer.write(connection, k, DATA)
    with Bag(tmp_path / "bag") as reader:
        assert reader.message_count == 10
    assert recover(tmp_path / "bag", tmp_path / "mended")["messages"] == 10


@pytest.fixture(scope="module")
def sound(tmp_path_factory: Any) -> list[Path]:
    """A bag of ours that was closed, one that was not, and one of another writer."""
    directory = tmp_path_factory.mktemp("sound")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(mcap_file, "DATA_ROOM", 2**20 + 2**16)
        patch.setattr(mcap_file, "SUMMARY_ROOM", 2**14)
        killed = BagWriter(directory / "killed", KINDS, {})
        killed.add(0, 1, DATA)
        killed.flush()
    types = get_typestore(Stores.ROS2_HUMBLE)
    with Writer(directory / "foreign", version=8, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connection = writer.add_connection("/a", "std_msgs/msg/Float64", typestore=types)
        writer.write(connection, 1, DATA)
    return [written(directory / "closed"), killed.path, directory / "foreign"]


@settings(max_examples=60, deadline=None)
@given(
    which=st.integers(0, 2),
    place=st.floats(0.0, 1.0),
    near_the_start=st.booleans(),
    damage=st.binary(min_size=1, max_size=30),
    cut=st.booleans(),
)
def test_whatever_is_damaged_gets_an_answer(
    sound: list[Path],
    tmp_path_factory: Any,
    which: int,
    place: float,
    near_the_start: bool,
    damage: bytes,
    cut: bool,
) -> None:
    """Reading and recovery work or refuse in one line; what was recovered reads."""
    bag = tmp_path_factory.mktemp("damaged") / "bag"
    shutil.copytree(sound[which], bag)
    (file,) = (each for each in bag.iterdir() if each.suffix in (".mcap", ".db3"))
    size = file.stat().st_size
    with file.open("r+b") as stream:
        stream.seek(int(place * (min(size, 5000) if near_the_start else size)))
        stream.write(damage)
        if cut:
            stream.truncate()
    read, mended = refusal(lambda: everything(bag)), bag.with_name("mended")
    assert read is None or "no readable bag" in read
    mending = refusal(lambda: recover(bag, mended))
    assert mending is None or "nothing that can be read" in mending
    if mending is None:
        everything(mended)


def everything(bag: Path) -> None:
    with Bag(bag) as reader:
        for connection, _, data in reader.messages():
            reader.deserialize(data, connection.msgtype)


def refusal(do: Callable[[], Any]) -> str | None:
    try:
        do()
    except ParameterError as error:
        assert "\n" not in str(error)
        return str(error)
    return None


@pytest.mark.parametrize("content", [b"", b"not a bag", b"\x89MCAP0\r\n" + b"\xff" * 100])
def test_rubbish_is_no_bag(tmp_path: Path, content: bytes) -> None:
    """Empty and foreign files are refused in one line, by reading and by recovery."""
    file = tmp_path / "x.mcap"
    file.write_bytes(content)
    with pytest.raises(ParameterError, match="no readable bag"), Bag(file):
        pass
    with pytest.raises(ParameterError, match="nothing that can be read"):
        recover(file, tmp_path / "mended")


def test_a_bag_too_long_for_memory_is_refused(tmp_path: Path, monkeypatch: Any) -> None:
    """By the counts in its summary, with topic and limit named."""
    monkeypatch.setattr("furuta_recordings.bags.bag.LONGEST", 10)
    connection = SimpleNamespace(topic="/measurement", msgcount=11)
    with pytest.raises(ParameterError, match="11 messages on /measurement, at most 10"):
        refuse_too_long(tmp_path, [connection])
    connection.msgcount = 10
    refuse_too_long(tmp_path, [connection])
