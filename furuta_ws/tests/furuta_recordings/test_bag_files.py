"""Bag files: readable after every flush, whatever ends the writer, and recovered when damaged."""

import errno
import os
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import threading
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import hostile_files
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.records import ChunkIndex
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from furuta_model.parameters import ParameterError
from furuta_recordings.bags import background_writer
from furuta_recordings.bags.background_writer import BackgroundWriter
from furuta_recordings.bags.bag import Bag
from furuta_recordings.bags.limits import MOST_TOPICS, parse_offered_qos
from furuta_recordings.bags.metadata import METADATA_FILE, SECTION, BagTopic, as_yaml, metadata
from furuta_recordings.bags.recovery import recover
from furuta_recordings.bags.writer import BagWriter
from furuta_recordings.readers import Mapping, read
from furuta_recordings.readers.axis_table import read_axis
from furuta_ros.yaml_files import read_yaml

TOPICS = [
    BagTopic("/a", "std_msgs/msg/Float64", "float64 data\n", ""),
    BagTopic("/b", "std_msgs/msg/Float64", "float64 data\n", ""),
]
# A Float64 in CDR: header, then eight bytes.
DATA = b"\x00\x01\x00\x00" + bytes(8)
WRITE_FOR_EVER = """
import itertools, sys
from pathlib import Path
from furuta_recordings.bags.writer import BagWriter
from furuta_recordings.bags.metadata import BagTopic
topics = [BagTopic("/a", "std_msgs/msg/Float64", "float64 data\\n", "")]
writer = BagWriter(Path(sys.argv[1]), topics, {"parameters.yaml": "plant: {}"})
for k in itertools.count():
    writer.add(0, k, b"\\x00\\x01\\x00\\x00" + k.to_bytes(8, "little"))
    if k % 50 == 0:
        writer.flush()
        print(k, flush=True)
"""


def times(bag: Path) -> list[int]:
    with Bag(bag) as opened:
        return [time for _, time, _ in opened.messages()]


def written(path: Path, messages: int = 1000) -> Path:
    """A closed bag of ours; times are numbers from 0 on."""
    writer = BagWriter(path, TOPICS, {})
    for k in range(messages):
        writer.add(k % 2, k, DATA)
    writer.close()
    return path


def written_by_another(
    path: Path, plugin: StoragePlugin, mode: CompressionMode = CompressionMode.NONE
) -> Path:
    types = get_typestore(Stores.ROS2_JAZZY)
    writer = Writer(path, version=9, storage_plugin=plugin)
    if mode != CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        topics = [
            writer.add_connection(name, "std_msgs/msg/Float64", typestore=types) for name in "ab"
        ]
        for k in range(40):
            writer.write(topics[k % 2], 10 * k, DATA[:4] + k.to_bytes(8, "little"))
    return path


def test_a_bag_is_readable_after_every_flush(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "bag", TOPICS, {"parameters.yaml": "plant: {}\n"})
    assert times(writer.path) == []
    for k in range(5):
        for j in range(10):
            writer.add(j % 2, 10 * k + j, DATA)
        writer.flush()
        assert times(writer.path) == list(range(10 * k + 10))
    writer.add(0, 99, DATA)
    writer.close()
    assert sorted(file.name for file in writer.path.iterdir()) == [
        *("bag_0.db3", "metadata.yaml", "parameters.yaml"),
    ]
    with AnyReader([writer.path]) as reader:
        assert [time for _, time, _ in reader.messages()] == [*range(50), 99]
        assert reader.message_count == 51
    with Bag(writer.path) as bag:
        assert {c.topic: c.msgcount for c in bag.connections} == {"/a": 26, "/b": 25}


@pytest.mark.parametrize("flushes", [1, 10])
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
    kept = times(bag)
    assert kept == list(range(len(kept)))
    assert len(kept) >= flushed > 50 * (flushes - 1)
    assert recover(bag, tmp_path / "recovered")["messages"] == len(kept)
    with AnyReader([tmp_path / "recovered"]) as reader:
        assert [time for _, time, _ in reader.messages()] == kept


def test_a_full_disk_ends_a_recording(tmp_path: Path) -> None:
    """The bag keeps what was written before; closing twice does no harm."""
    writer = BackgroundWriter(tmp_path / "bag", TOPICS, {})
    writer.add(0, 1, DATA)
    writer._flush()
    writer._check()
    database = writer._writer._database
    pages = database.execute("PRAGMA page_count").fetchone()[0]
    database.execute(f"PRAGMA max_page_count = {pages}")
    writer.add(0, 2, bytes(2**20))
    writer.close()
    writer.close()
    assert "disk is full" in str(writer.failure)
    assert times(writer.path) == [1]


def test_all_messages_are_written(tmp_path: Path) -> None:
    writer = BackgroundWriter(tmp_path / "bag", TOPICS, {"parameters.yaml": "plant: {}\n"})
    assert (tmp_path / "bag" / "parameters.yaml").read_text() == "plant: {}\n"
    contents = [os.urandom(size) for size in (0, 1, 70_000, 3_000_000, *range(250))]
    for time, content in enumerate(contents):
        writer.add(0, time, content)
        writer.send(wait_for_disk=time % 2 == 0)
    writer.close()
    assert writer.failure is None
    with Bag(tmp_path / "bag") as bag:
        assert [(time, bytes(data)) for _, time, data in bag.messages()] == [*enumerate(contents)]


def test_a_recorder_does_not_wait_for_a_slow_disk(tmp_path: Path, monkeypatch: Any) -> None:
    """Until too much is waiting: then recording ends, or in lock-step it waits."""
    monkeypatch.setattr(background_writer, "LARGEST_BACKLOG", 2**20)
    for wait in (False, True):
        disk = threading.Event()
        writer = BackgroundWriter(tmp_path / f"bag_{wait}", TOPICS, {})
        writer._writing = writer._thread.submit(lambda disk=disk: disk.wait() and None)
        writer.add(0, 0, bytes(2**20))
        writer.send()
        assert writer.failure is None
        writer.add(0, 1, b"1")
        threading.Timer(0.1, disk.set).start() if wait else None
        writer.send(wait_for_disk=wait)
        disk.set()
        writer.close()
        assert wait or "the disk is too slow" in str(writer.failure)
        assert times(writer.path) == ([0, 1] if wait else [])


def test_a_bag_that_cannot_be_created(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("not a directory")
    for path, reason in (
        (tmp_path, "already exists"),
        (tmp_path / "file" / "bag", "file: File exists"),
    ):
        with pytest.raises(ParameterError, match=reason) as error:
            BackgroundWriter(path, TOPICS, {})
        assert "\n" not in str(error.value)


def mcap_file(file: Path) -> list[ChunkIndex]:
    """A file of many small chunks with checksums; times are numbers from 0 to 999."""
    with file.open("wb") as stream:
        writer = McapWriter(stream, chunk_size=1000, compression=CompressionType.NONE)
        writer.start("ros2", "test")
        schema = writer.register_schema("std_msgs/msg/Float64", "ros2msg", b"float64 data")
        channel = writer.register_channel("/a", "cdr", schema)
        for k in range(1000):
            writer.add_message(channel, k, DATA, k)
        writer.finish()
    with file.open("rb") as stream:
        return make_reader(stream).get_summary().chunk_indexes


@pytest.mark.parametrize("part", [0.3, 0.95])
def test_recover_truncated(tmp_path: Path, part: float) -> None:
    """A truncated MCAP file is refused; what stands before the cut is recovered."""
    file = tmp_path / "bag.mcap"
    chunks = mcap_file(file)
    size = int(part * file.stat().st_size)
    with file.open("r+b") as stream:
        stream.truncate(size)
    with pytest.raises(ParameterError, match="not a readable bag"), Bag(file):
        pass
    recover(file, tmp_path / "recovered")
    complete = [c for c in chunks if c.chunk_start_offset + c.chunk_length <= size]
    assert times(tmp_path / "recovered") == list(range(complete[-1].message_end_time + 1))


def test_a_damaged_chunk_is_left_out(tmp_path: Path) -> None:
    """It costs that chunk alone, and is named."""
    file = tmp_path / "bag.mcap"
    chunk = mcap_file(file)[5]
    content = bytearray(file.read_bytes())
    content[chunk.chunk_start_offset + chunk.chunk_length - 5] ^= 0xFF
    file.write_bytes(content)
    (problem,) = recover(file, tmp_path / "recovered")["problems"]
    assert "left out a chunk" in problem
    lost = range(chunk.message_start_time, chunk.message_end_time + 1)
    assert times(tmp_path / "recovered") == [k for k in range(1000) if k not in lost]


def test_recover_without_metadata(tmp_path: Path) -> None:
    bag = written(tmp_path / "bag")
    (bag / "metadata.yaml").unlink()
    with pytest.raises(ParameterError, match="not a readable bag"), Bag(bag):
        pass
    assert recover(bag, tmp_path / "recovered")["messages"] == 1000


@pytest.mark.parametrize("mode", [CompressionMode.FILE, CompressionMode.MESSAGE])
def test_bags_that_rosbag2_compressed_are_refused(tmp_path: Path, mode: CompressionMode) -> None:
    bag = written_by_another(tmp_path / "bag", StoragePlugin.MCAP, mode)
    with pytest.raises(ParameterError, match="is compressed: write it anew with"), Bag(bag):
        pass


@pytest.mark.parametrize("plugin", [None, StoragePlugin.SQLITE3, StoragePlugin.MCAP])
def test_messages_are_found_by_their_times(tmp_path: Path, plugin: StoragePlugin | None) -> None:
    """In the order of their times, whoever wrote the bag; it can be recovered too."""
    bag = tmp_path / "bag"
    bag = written(bag, 400) if plugin is None else written_by_another(bag, plugin)
    with Bag(bag) as opened:
        topic = opened.connections[0]
        received, contents = opened.find(topic, 100, 301)
        assert received.tolist() == [t for t in times(bag) if 100 <= t < 301][::2]
        assert len(contents) == len(received)
    assert recover(bag, tmp_path / "recovered")["messages"] == len(times(bag))


def test_more_messages_than_a_file_claims_do_not_fill_the_memory(
    tmp_path: Path, monkeypatch: Any
) -> None:
    """What a file claims counts too."""
    bag = written(tmp_path / "bag")
    monkeypatch.setattr("furuta_recordings.bags.bag.MOST_IN_MEMORY", 400)
    with Bag(bag) as opened:
        for claim, counted in ((1, 401), (900, 900)):
            claimed = [topic._replace(msgcount=claim) for topic in opened.connections]
            reason = f"{counted} messages on /a, at most 400 fit"
            with pytest.raises(ParameterError, match=reason):
                list(opened.messages_in_memory(claimed))


@pytest.fixture(scope="module")
def intact(tmp_path_factory: Any) -> list[Path]:
    """A bag of ours that was closed, one that was not, and two of another writer."""
    directory = tmp_path_factory.mktemp("intact")
    killed = BagWriter(directory / "killed", TOPICS, {})
    killed.add(0, 1, DATA)
    killed.flush()
    others = (StoragePlugin.SQLITE3, StoragePlugin.MCAP)
    return [
        written(directory / "closed"),
        shutil.copytree(killed.path, directory / "copy"),
        *(written_by_another(directory / plugin.name, plugin) for plugin in others),
    ]


@settings(max_examples=60, deadline=None)
@given(
    which=st.integers(0, 3),
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
        times(recovered)


def read_all(bag: Path) -> None:
    with Bag(bag) as opened:
        for connection, _, data in opened.messages():
            opened.deserialize(data, connection.msgtype)


def error_of(do: Callable[[], Any]) -> str | None:
    try:
        do()
    except ParameterError as error:
        assert "\n" not in str(error)
        return str(error)
    return None


def test_rosbag2_finds_its_tables(tmp_path: Path) -> None:
    """Schema version 4, with type definitions, as rosbag2 of Jazzy reads them."""
    bag = written(tmp_path / "bag")
    with closing(sqlite3.connect(bag / "bag_0.db3")) as database:
        assert database.execute("SELECT * FROM schema").fetchall() == [(4, "jazzy")]
        (definition,) = database.execute("SELECT * FROM message_definitions").fetchall()
    assert definition[1:4] == ("std_msgs/msg/Float64", "ros2msg", "float64 data\n")


def test_megabytes_of_offered_qualities_of_service_are_refused() -> None:
    """The library's reader of YAML would take minutes."""
    with pytest.raises(ParameterError, match="described by 3000000 characters"):
        parse_offered_qos("[" + "1, " * 999_999 + "1]")


@pytest.mark.parametrize(
    ("table", "column", "value", "found", "kept"),
    [
        ("topics", "name", "NULL", "null, must be text", 20),
        ("topics", "type", "7", "integer, must be text", 20),
        ("topics", "id", "1.5", "real, must be integer", 20),
        ("messages", "topic_id", "NULL", "null, must be integer", 39),
        ("messages", "timestamp", "1.5", "real, must be integer", 39),
        ("messages", "timestamp", "'now'", "text, must be integer", 39),
        ("messages", "data", "'text'", "text, must be blob", 39),
        ("message_definitions", "encoding", "x'00'", "blob, must be text", 40),
        ("schema", "schema_version", "NULL", "null, must be integer", 40),
    ],
)
def test_a_column_with_another_type_is_named(
    tmp_path: Path, table: str, column: str, value: str, found: str, kept: int
) -> None:
    """The bag is refused; a recovery keeps the messages that have all they need."""
    bag = written(tmp_path / "bag", 40)
    with closing(sqlite3.connect(bag / "bag_0.db3")) as database, database:
        names = [name for _, name, *_ in database.execute(f"PRAGMA table_info({table})")]
        rows = database.execute(f"SELECT * FROM {table}").fetchall()
        database.execute(f"DROP TABLE {table}")
        database.execute(f"CREATE TABLE {table}({','.join(names)})")  # takes all types
        database.executemany(f"INSERT INTO {table} VALUES ({','.join('?' * len(names))})", rows)
        database.execute(f"UPDATE {table} SET {column} = {value} WHERE rowid = 1")
    reason = f"{table}.{column} holds {found}"
    with pytest.raises(ParameterError, match=re.escape(reason)), Bag(bag):
        pass
    recovered = recover(bag, tmp_path / "recovered")
    assert recovered["messages"] == kept == len(times(tmp_path / "recovered"))
    assert reason in recovered["problems"][0]


def test_a_damaged_page_costs_what_comes_after_it(tmp_path: Path) -> None:
    bag = written(tmp_path / "bag", 3000)
    file = bag / "bag_0.db3"
    content = bytearray(file.read_bytes())
    middle = len(content) // 2 // 4096 * 4096
    content[middle : middle + 8192] = b"\xff" * 8192
    file.write_bytes(content)
    assert recover(bag, tmp_path / "recovered")["messages"] > 500
    kept = times(tmp_path / "recovered")
    assert kept == list(range(len(kept)))


def test_a_time_beyond_64_bits_is_refused(tmp_path: Path) -> None:
    """MCAP has room for it; a recovery names the message that it leaves out."""
    file = tmp_path / "bag.mcap"
    with file.open("wb") as stream:
        writer = McapWriter(stream)
        writer.start("ros2", "test")
        schema = writer.register_schema("std_msgs/msg/Float64", "ros2msg", b"float64 data")
        channel = writer.register_channel("/a", "cdr", schema)
        for time in (5, 2**63):
            writer.add_message(channel, time, DATA, time)
        writer.finish()
    with pytest.raises(ParameterError, match="/a has the time 9223372036854775808 ns"):
        times(file)
    (problem,) = recover(file, tmp_path / "recovered")["problems"]
    assert "left out a message with the time 9223372036854775808 ns" in problem
    assert times(tmp_path / "recovered") == [5]


def test_metadata_of_the_most_topics_are_readable(tmp_path: Path) -> None:
    """Those of a recovered bag, which knows no quality of service."""
    hashed = "RIHS01_" + 64 * "0"
    topics = [
        TOPICS[0]._replace(name=f"/robot/group/topic_{k}", type_hash=hashed)
        for k in range(MOST_TOPICS)
    ]
    about = metadata(topics, [0] * MOST_TOPICS, "bag_0.db3", (0, 0))
    (tmp_path / METADATA_FILE).write_text(as_yaml({SECTION: about}))
    assert read_yaml(tmp_path / METADATA_FILE, "metadata") == {SECTION: about}


def test_a_recovery_says_what_it_has_lost(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Too many topics; what it writes is readable."""
    names = [f"/{k}" for k in range(20)]
    writer = BagWriter(tmp_path / "bag", [TOPICS[0]._replace(name=name) for name in names], {})
    for k in range(40):
        writer.add(k % 20, k, DATA)
    writer.close()
    monkeypatch.setattr("furuta_recordings.bags.recovery.MOST_TOPICS", 12)
    reason = r"lacks 16 messages on topics after the first 12, .* it holds 24 messages"
    with pytest.raises(ParameterError, match=reason):
        recover(tmp_path / "bag", tmp_path / "recovered")
    assert len(times(tmp_path / "recovered")) == 24


def test_a_full_disk_leaves_no_unfinished_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither when the bag is closed nor when it is made."""
    write = Path.write_text

    def half(file: Path, text: str) -> int:
        write(file, text[: len(text) // 2])
        raise OSError(errno.ENOSPC, "No space left on device", str(file))

    writer = BagWriter(tmp_path / "bag", TOPICS, {})
    before = sorted(tmp_path.rglob("*.yaml*"))
    monkeypatch.setattr(Path, "write_text", half)
    with pytest.raises(OSError, match="No space left"):
        writer.close()
    with pytest.raises(OSError, match="No space left"):
        BagWriter(tmp_path / "new", TOPICS, {})
    assert sorted(tmp_path.rglob("*.yaml*")) == before
    assert [path.name for path in tmp_path.iterdir()] == ["bag"]


def test_a_bag_in_the_working_directory_has_a_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(hostile_files.sound_bag(tmp_path / "bag"))
    assert read(Path(), Mapping()).name == "bag"


BEGIN, BOOT = 1_700_000_000_000_000_000, 7_000_000_000
STEP = 10_000_000


def joint_bag(
    path: Path, messages: list[tuple[int, int, dict[str, tuple[float, ...]] | float]]
) -> Path:
    """A bag of messages (arrival, stamp [ns], content): joints with their numbers, or a command."""
    types = get_typestore(Stores.ROS2_JAZZY)
    make = types.types.__getitem__
    with Writer(path, version=9) as writer:
        kinds = ("sensor_msgs/msg/JointState", "std_msgs/msg/Float64")
        states, command = (
            writer.add_connection(topic, kind, typestore=types)
            for topic, kind in zip(("/joint_states", "/command"), kinds, strict=True)
        )
        for arrival, stamp, content in messages:
            if isinstance(content, float):
                topic, message = command, make(kinds[1])(content)
            else:
                time = make("builtin_interfaces/msg/Time")(*divmod(stamp, 10**9))
                series = [np.array(each) for each in zip(*content.values(), strict=True)]
                series += [np.zeros(0)] * (3 - len(series))
                header = make("std_msgs/msg/Header")(time, "")
                topic, message = states, make(kinds[0])(header, list(content), *series)
            writer.write(topic, arrival, types.serialize_cdr(message, message.__msgtype__))
    return path


@pytest.mark.parametrize(("offset", "apart"), [(0, False), (BOOT - BEGIN, True)])
def test_stamps_and_times_of_arrival_are_not_mixed(
    tmp_path: Path, offset: int, apart: bool
) -> None:
    """Where commands have no stamp, those of another clock are not used."""
    messages: list[Any] = []
    for k in range(200):
        at, late = BEGIN + k * STEP, STEP // 10 * (k % 2)
        messages.append((at + late, at + offset, {"arm": (0.1 * k,), "pendulum": (3.0,)}))
        messages.append((at + STEP // 5, 0, float(k)))
    found = read(joint_bag(tmp_path / "bag", messages), Mapping())
    delay = 1e-3 * (np.arange(200) % 2) if apart else 0.0
    np.testing.assert_allclose(found.time, 0.01 * np.arange(200) + delay, atol=1e-9)
    np.testing.assert_allclose(found.command_time, 0.01 * np.arange(200) + 0.002, atol=1e-9)
    assert any("times of arrival used for both" in text for text in found.findings) == apart


def test_joints_of_all_messages(tmp_path: Path) -> None:
    """Another joint comes first, and arm and pendulum in turn."""
    messages: list[Any] = [(BEGIN, BEGIN, {"gripper": (5.0,)})]
    for k in range(400):
        at = BEGIN + k * STEP
        joint = {"pendulum": (0.02 * k,)} if k % 2 else {"arm": (0.01 * k,)}
        messages.append((at, at, joint))
        messages.append((at, 0, float(k)))
    bag = joint_bag(tmp_path / "bag", messages)
    found = read(bag, Mapping())
    np.testing.assert_allclose(found.measured[:, 0], 0.01 * np.arange(2, 400, 2))
    np.testing.assert_allclose(found.measured[:, 2], 2.0 * found.measured[:, 0])
    with pytest.raises(ParameterError, match="no joint elbow; it has gripper, arm, pendulum"):
        read(bag, Mapping(arm="elbow"))


def test_an_axis_from_a_bag(tmp_path: Path) -> None:
    """One joint that wraps, with velocity and effort; or the command of a topic."""
    turns = np.linspace(0.0, 20.0, 300)
    wrapped = (turns + np.pi) % (2.0 * np.pi) - np.pi
    messages: list[Any] = []
    for k, angle in enumerate(wrapped):
        at = BEGIN + k * STEP
        messages.append((at, at, {"a": (0.0, 0.0, 0.0), "b": (angle, 1.0, 0.5 * k)}))
        messages.append((at, 0, 7.0))
    bag = joint_bag(tmp_path / "bag", messages)
    found = read_axis(bag, joint="b", torque_constant=2.0)
    np.testing.assert_allclose(found.measured[:, 0], turns)
    np.testing.assert_allclose(found.measured[:, 1], 1.0)
    np.testing.assert_allclose(found.command, np.arange(300.0))
    assert "begins anew after 6.28319" in found.findings[-1]
    assert set(read_axis(bag, joint="b", command="command").command) == {7.0}
    for options, words in (
        ({}, "any of a, b may be the axis; name it with --joint"),
        ({"joint": "c"}, "no joint c; it has a, b"),
        ({"position": "b"}, "a bag has no columns"),
    ):
        with pytest.raises(ParameterError, match=words):
            read_axis(bag, **options)
