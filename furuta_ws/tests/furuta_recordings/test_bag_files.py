"""Bag files: complete at every moment of writing, and recovered when damaged."""

from __future__ import annotations

import errno
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.records import ChunkIndex
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from furuta_model.parameters import ParameterError
from furuta_recordings.bags import mcap_file
from furuta_recordings.bags.bag import Bag, refuse_too_long
from furuta_recordings.bags.mcap_records import FOOTER_SIZE, BagTopic
from furuta_recordings.bags.recovery import recover
from furuta_recordings.bags.writer import BagWriter

TOPICS = [
    BagTopic("/a", "std_msgs/msg/Float64", "float64 data\n", ""),
    BagTopic("/b", "std_msgs/msg/Float64", "float64 data\n", ""),
]
# A Float64 in CDR: header, then eight bytes.
DATA = b"\x00\x01\x00\x00" + bytes(8)
# A chunk, its head, a summary, a footer.
WRITES_PER_FLUSH = 4
WRITE_FOR_EVER = """
import itertools, sys, time
from pathlib import Path
from furuta_recordings.bags.writer import BagWriter
from furuta_recordings.bags.mcap_records import BagTopic
topics = [BagTopic("/a", "std_msgs/msg/Float64", "float64 data\\n", "")]
writer = BagWriter(Path(sys.argv[1]), topics, {"parameters.yaml": "plant: {}"})
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


def test_a_bag_is_complete_after_every_flush(tmp_path: Path) -> None:
    """Before and after it is closed; closing cuts off the unused space."""
    writer = BagWriter(tmp_path / "bag", TOPICS, {"parameters.yaml": "plant: {}\n"})
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
    with Bag(writer.path) as bag:
        assert {c.topic: c.msgcount for c in bag.connections} == {"/a": 26, "/b": 25}
        assert [time for _, time, _ in bag.messages()][-1] == 99


def test_a_full_file_is_followed_by_another(tmp_path: Path, monkeypatch: Any) -> None:
    """As rosbag2 splits bags; order and number of messages stay."""
    monkeypatch.setattr(mcap_file, "DATA_SPACE", 2**20 + 10_000)
    writer = BagWriter(tmp_path / "bag", TOPICS, {})
    for k in range(1000):
        writer.add(0, k, DATA)
        if k % 10 == 0:
            writer.flush()
    writer.close()
    assert len(list(writer.path.glob("*.mcap"))) > 2
    assert counts(writer.path) == (1000, 1000)
    with Bag(writer.path) as bag:
        assert [time for _, time, _ in bag.messages()] == list(range(1000))


def test_more_topics_than_a_summary_holds_are_refused(tmp_path: Path) -> None:
    """They would overwrite the end of the file."""
    long = "# " + "x" * 2**12 + "\nfloat64 data\n"
    topics = [BagTopic(f"/t{k}", f"a_msgs/msg/T{k}", long, "") for k in range(200)]
    with pytest.raises(ParameterError, match=r"200 topics with .* at most 524288 bytes fit"):
        BagWriter(tmp_path / "bag", topics, {})
    assert not (tmp_path / "bag").exists()


class Killed(BaseException):
    """Stands for SIGKILL: nothing of the process runs afterwards."""


@pytest.mark.parametrize("last", range(12))
def test_killed_at_every_write(tmp_path: Path, monkeypatch: Any, last: int) -> None:
    """Killed during the write after ``last`` others: every finished flush is in the bag.

    The interrupted write is half done, except for heads and footers, which are in one disk block.
    Until a summary names the first chunk, readers scan the data and find it earlier.
    """
    writer = BagWriter(tmp_path / "bag", TOPICS, {})
    pwrite, writes, flushes = os.pwrite, 0, 0

    def killed(file: int, data: memoryview, offset: int) -> int:
        nonlocal writes, flushes
        if writes == last:
            pwrite(file, data[: len(data) // 2 if len(data) > FOOTER_SIZE else 0], offset)
            raise Killed
        writes += 1
        flushes += len(data) == FOOTER_SIZE
        return pwrite(file, data, offset)

    monkeypatch.setattr(os, "pwrite", killed)
    with pytest.raises(Killed):
        for k in range(100):
            writer.add(0, k, b"x" * 50_000)
            writer.flush()
    monkeypatch.undo()
    assert flushes == last // WRITES_PER_FLUSH
    expected = flushes or int(last >= 2)
    assert counts(writer.path) == (expected, expected)


@pytest.mark.parametrize("flushes", [1, 2, 3, 5, 10, 20, 50])
def test_sigkill_while_writing(tmp_path: Path, flushes: int) -> None:
    """A writer that writes without pause is killed: everything that was flushed is in the bag."""
    bag = tmp_path / "bag"
    child = subprocess.Popen(
        [sys.executable, "-c", WRITE_FOR_EVER, str(bag)], stdout=subprocess.PIPE, text=True
    )
    assert child.stdout is not None
    lines = [child.stdout.readline() for _ in range(flushes)]
    child.send_signal(signal.SIGKILL)
    lines += child.communicate()[0].splitlines(keepends=True)
    flushed = 1 + max(int(line) for line in lines if line.endswith("\n"))
    by_rosbags, by_mcap = counts(bag)
    assert by_rosbags == by_mcap >= flushed > 50 * (flushes - 1)


def test_a_full_disk_keeps_what_was_written_before(tmp_path: Path, monkeypatch: Any) -> None:
    """Writing fails, and the bag is still readable."""
    writer = BagWriter(tmp_path / "bag", TOPICS, {})
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
    """A closed bag with 50 messages per chunk; times are numbers from 0 on."""
    writer = BagWriter(path, TOPICS, {})
    for k in range(chunks):
        for j in range(50):
            writer.add(j % 2, 50 * k + j, DATA)
        writer.flush()
    writer.close()
    return path


def chunks_of(file: Path) -> list[ChunkIndex]:
    with file.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    return summary.chunk_indexes


def times(bag: Path) -> list[int]:
    with Bag(bag) as opened:
        return [time for _, time, _ in opened.messages()]


@pytest.mark.parametrize("part", [0.3, 0.6, 0.95])
def test_recover_truncated(tmp_path: Path, part: float) -> None:
    """Every chunk before the cut is recovered; the truncated bag itself is refused."""
    bag = written(tmp_path / "bag")
    (file,) = bag.glob("*.mcap")
    size = int(part * file.stat().st_size)
    complete = sum(c.chunk_start_offset + c.chunk_length <= size for c in chunks_of(file))
    assert complete > 0
    os.truncate(file, size)
    with pytest.raises(ParameterError, match="not a readable bag"), Bag(bag):
        pass
    result = recover(bag, tmp_path / "recovered")
    assert result["messages"] == 50 * complete
    assert times(tmp_path / "recovered") == list(range(50 * complete))


@pytest.mark.parametrize(
    ("in_the_chunk", "lost"), [(True, range(500, 550)), (False, range(0))], ids=["chunk", "index"]
)
def test_recover_corrupted(tmp_path: Path, in_the_chunk: bool, lost: range) -> None:
    """Damage in a chunk costs that chunk alone; damage in a message index costs nothing."""
    bag = written(tmp_path / "bag")
    (file,) = bag.glob("*.mcap")
    chunk = chunks_of(file)[10]
    end = chunk.chunk_start_offset + chunk.chunk_length
    content = bytearray(file.read_bytes())
    content[end - 20 if in_the_chunk else end + 20] ^= 0xFF
    file.write_bytes(content)
    result = recover(bag, tmp_path / "recovered")
    assert len(result["problems"]) == bool(lost)
    assert times(tmp_path / "recovered") == [t for t in range(1000) if t not in lost]


def test_recover_without_metadata(tmp_path: Path) -> None:
    """A bag without metadata.yaml."""
    bag = written(tmp_path / "bag")
    (bag / "metadata.yaml").unlink()
    with pytest.raises(ParameterError, match="not a readable bag"), Bag(bag):
        pass
    assert recover(bag, tmp_path / "recovered")["messages"] == 1000


@pytest.mark.parametrize("plugin", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
def test_bags_of_other_writers(tmp_path: Path, plugin: StoragePlugin) -> None:
    """They are read and recovered, sqlite3 and mcap."""
    types = get_typestore(Stores.ROS2_HUMBLE)
    with Writer(tmp_path / "bag", version=8, storage_plugin=plugin) as writer:
        connection = writer.add_connection("/a", "std_msgs/msg/Float64", typestore=types)
        for k in range(10):
            writer.write(connection, k, DATA)
    with Bag(tmp_path / "bag") as reader:
        assert reader.message_count == 10
    assert recover(tmp_path / "bag", tmp_path / "recovered")["messages"] == 10


@pytest.mark.parametrize("mode", [CompressionMode.FILE, CompressionMode.MESSAGE])
def test_compressed_bags_are_read(tmp_path: Path, mode: CompressionMode) -> None:
    """As rosbag2 compresses them, file by file or message by message."""
    types = get_typestore(Stores.ROS2_JAZZY)
    writer = Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connection = writer.add_connection("/a", "std_msgs/msg/Float64", typestore=types)
        for k in range(10):
            writer.write(connection, k, DATA)
    with Bag(tmp_path / "bag") as bag:
        assert [(time, data) for _, time, data in bag.messages()] == [(k, DATA) for k in range(10)]
    assert not list(Path(tempfile.gettempdir()).glob("furuta-bag-*/bag_0.mcap"))


def bag_of_another_writer(path: Path, plugin: StoragePlugin, mode: CompressionMode) -> Path:
    types = get_typestore(Stores.ROS2_JAZZY)
    writer = Writer(path, version=9, storage_plugin=plugin)
    if mode != CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        topics = [
            writer.add_connection(name, "std_msgs/msg/Float64", typestore=types) for name in "ab"
        ]
        for k in range(40):
            writer.write(topics[k % 2], 1000 - 10 * k, DATA[:4] + k.to_bytes(8, "little"))
    return path


def own_bag(path: Path, monkeypatch: Any) -> Path:
    """Of several files, and not closed, as after a kill."""
    monkeypatch.setattr(mcap_file, "DATA_SPACE", 2**20 + 5_000)
    writer = BagWriter(path, TOPICS, {})
    for k in range(400):
        writer.add(k % 2, 1000 - k, DATA[:4] + k.to_bytes(8, "little"))
        if k % 25 == 24:
            writer.flush()
    assert len(list(path.glob("*.mcap"))) > 2
    return path


@pytest.mark.parametrize("kind", ["own", "mcap", "sqlite3", "by file", "by message"])
def test_messages_are_found_by_their_times(tmp_path: Path, monkeypatch: Any, kind: str) -> None:
    """The same as all that are read, in the order of their times, whoever wrote the bag."""
    plugin = StoragePlugin.SQLITE3 if kind == "sqlite3" else StoragePlugin.MCAP
    modes = {"by file": CompressionMode.FILE, "by message": CompressionMode.MESSAGE}
    if kind == "own":
        bag = own_bag(tmp_path / "bag", monkeypatch)
    else:
        mode = modes.get(kind, CompressionMode.NONE)
        bag = bag_of_another_writer(tmp_path / "bag", plugin, mode)
    with Bag(bag) as opened:
        for topic in opened.connections:
            for first, last in ((0, 2000), (700, 901), (2000, 3000)):
                found = opened.find(topic, first, last)
                by_time = sorted(
                    (t, data) for _, t, data in opened.messages([topic], (first, last))
                )
                assert found.times.tolist() == [time for time, _ in by_time]
                assert [found[k] for k in range(len(by_time))] == [data for _, data in by_time]


def test_a_damaged_chunk_is_not_shown(tmp_path: Path) -> None:
    """Its checksum tells; messages elsewhere are found."""
    bag = written(tmp_path / "bag")
    (file,) = bag.glob("*.mcap")
    chunk = chunks_of(file)[10]
    content = bytearray(file.read_bytes())
    content[chunk.chunk_start_offset + chunk.chunk_length - 1] ^= 0xFF
    file.write_bytes(content)
    with Bag(bag) as opened:
        found = opened.find(opened.connections[0], 0, 1000)
        assert found[0] == DATA
        with pytest.raises(ParameterError, match="a chunk with a wrong checksum"):
            found[len(found.times) * 10 // 20]


def test_a_topic_without_messages_is_listed(tmp_path: Path) -> None:
    """Also if only the metadata knows it."""
    bag = written(tmp_path / "bag")
    metadata = bag / "metadata.yaml"
    metadata.write_text(metadata.read_text().replace('name: "/b"', 'name: "/c"'))
    with Bag(bag) as opened:
        counts = {each.topic: each.msgcount for each in opened.connections}
    assert counts == {"/a": 500, "/b": 500, "/c": 0}


def test_more_messages_than_a_file_claims_do_not_fill_the_memory(
    tmp_path: Path, monkeypatch: Any
) -> None:
    """They are counted on the way."""
    bag = written(tmp_path / "bag")
    monkeypatch.setattr("furuta_recordings.bags.bag.MOST_IN_MEMORY", 400)
    with Bag(bag) as opened:
        claimed = [each._replace(msgcount=1) for each in opened.connections]
        with pytest.raises(ParameterError, match="401 messages on /a, at most 400 fit"):
            list(opened.messages_in_memory(claimed))


@pytest.fixture(scope="module")
def intact(tmp_path_factory: Any) -> list[Path]:
    """A bag of ours that was closed, one that was not, and one of another writer."""
    directory = tmp_path_factory.mktemp("intact")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(mcap_file, "DATA_SPACE", 2**20 + 2**16)
        patch.setattr(mcap_file, "SUMMARY_SPACE", 2**14)
        killed = BagWriter(directory / "killed", TOPICS, {})
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
def test_damage_anywhere(
    intact: list[Path],
    tmp_path_factory: Any,
    which: int,
    place: float,
    near_the_start: bool,
    damage: bytes,
    cut: bool,
) -> None:
    """Reading and recovery succeed or fail with one line; a recovered bag is readable."""
    bag = tmp_path_factory.mktemp("damaged") / "bag"
    shutil.copytree(intact[which], bag)
    (file,) = (each for each in bag.iterdir() if each.suffix in (".mcap", ".db3"))
    size = file.stat().st_size
    with file.open("r+b") as stream:
        stream.seek(int(place * (min(size, 5000) if near_the_start else size)))
        stream.write(damage)
        if cut:
            stream.truncate()
    reading, recovered = error_of(lambda: read_all(bag)), bag.with_name("recovered")
    assert reading is None or "not a readable bag" in reading
    recovering = error_of(lambda: recover(bag, recovered))
    assert recovering is None or "no message that can be read" in recovering
    if recovering is None:
        read_all(recovered)


def read_all(bag: Path) -> None:
    with Bag(bag) as opened:
        for connection, _, data in opened.messages():
            opened.deserialize(data, connection.msgtype)
        for each in opened.connections:
            found = opened.find(each, 0, 2**62)
            for number in range(len(found.times)):
                opened.deserialize(found[number], each.msgtype)


def error_of(do: Callable[[], Any]) -> str | None:
    try:
        do()
    except ParameterError as error:
        assert "\n" not in str(error)
        return str(error)
    return None


@pytest.mark.parametrize("content", [b"", b"not a bag", b"\x89MCAP0\r\n" + b"\xff" * 100])
def test_other_files_are_not_bags(tmp_path: Path, content: bytes) -> None:
    """Empty and other files are refused in one line, by reading and by recovery."""
    file = tmp_path / "x.mcap"
    file.write_bytes(content)
    with pytest.raises(ParameterError, match="not a readable bag"), Bag(file):
        pass
    with pytest.raises(ParameterError, match="no message that can be read"):
        recover(file, tmp_path / "recovered")


def test_a_bag_too_long_for_memory_is_refused(tmp_path: Path, monkeypatch: Any) -> None:
    """By the counts in its summary; the message names topic and limit."""
    monkeypatch.setattr("furuta_recordings.bags.bag.MOST_IN_MEMORY", 10)
    connection = SimpleNamespace(topic="/measurement", msgcount=11)
    with pytest.raises(ParameterError, match="11 messages on /measurement, at most 10 fit"):
        refuse_too_long(tmp_path, [connection])
    connection.msgcount = 10
    refuse_too_long(tmp_path, [connection])
