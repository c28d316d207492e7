"""Bag files: complete messages are recovered whatever ends the writer; series of other rigs."""

import resource
import shlex
import shutil
import signal
import sqlite3
import subprocess
import sys
import threading
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from joint_bags import joint_bag
from mcap.reader import NonSeekingReader, make_reader
from mcap.writer import Writer as McapWriter
from rosbags.highlevel import AnyReader
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from furuta_model.parameters import ParameterError
from furuta_recordings.bags import writer as module
from furuta_recordings.bags.bag import Bag
from furuta_recordings.bags.metadata import BagTopic
from furuta_recordings.bags.recovery import recover
from furuta_recordings.bags.series import Series
from furuta_recordings.bags.writer import BagWriter
from furuta_recordings.readers import Mapping, read, read_axis
from furuta_ros.errors import UserError

TOPICS = [
    BagTopic("/a", "std_msgs/msg/Float64", "float64 data\n", ""),
    BagTopic("/b", "std_msgs/msg/Float64", "float64 data\n", ""),
]
# A Float64 in CDR: header, then eight bytes.
DATA = b"\x00\x01\x00\x00" + bytes(8)
WRITE_FOR_EVER = """
import itertools, sys
from pathlib import Path
from furuta_recordings.bags import writer as module
from furuta_recordings.bags.metadata import BagTopic
module.FLUSH_INTERVAL = 0.0
topics = [BagTopic("/a", "std_msgs/msg/Float64", "float64 data\\n", "")]
writer = module.BagWriter(Path(sys.argv[1]), topics, {"parameters.yaml": "plant: {}"})
for k in itertools.count():
    writer.add(0, k, b"\\x00\\x01\\x00\\x00" + k.to_bytes(8, "little"))
    if k % 50 == 0:
        writer._file._writing.result()
        print(k - 50, flush=True)
        writer.flush()
"""


def times(bag: Path) -> list[int]:
    with Bag(bag) as opened:
        return [time for _, time, _ in opened.messages()]


def written(path: Path, messages: int = 1000) -> Path:
    """A closed bag of ours; times are numbers from 0 on, most of them in chunks of 50."""
    writer = BagWriter(path, TOPICS, {"parameters.yaml": "plant: {}\n"})
    for k in range(messages):
        writer.add(k % 2, k, DATA)
        if k % 50 == 49:
            writer._writer.flush()
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


def test_a_closed_bag_is_complete(tmp_path: Path) -> None:
    """For us and for others; whatever the order of the times."""
    writer = BagWriter(tmp_path / "bag", TOPICS, {"parameters.yaml": "plant: {}\n"})
    contents = [bytes(size) for size in (0, 1, 70_000, 3_000_000, *range(250))]
    for time, content in enumerate(contents):
        writer.add(time % 2, len(contents) - time, content)
        writer.flush()
    writer.close()
    writer.close()
    assert sorted(file.name for file in writer.path.iterdir()) == [
        *("bag_0.mcap", "metadata.yaml", "parameters.yaml"),
    ]
    with AnyReader([writer.path]) as reader:
        assert [time for _, time, _ in reader.messages()] == [*range(1, len(contents) + 1)]
        assert reader.message_count == len(contents)
    with (tmp_path / "bag" / "bag_0.mcap").open("rb") as file:
        messages = make_reader(file, validate_crcs=True).iter_messages()
        assert [message.data for _, _, message in messages] == contents[::-1]
    with Bag(writer.path) as bag:
        assert [bytes(data) for _, _, data in bag.messages()] == contents[::-1]
        assert {c.topic: c.msgcount for c in bag.connections} == {"/a": 127, "/b": 127}


def test_sigkill_while_writing(tmp_path: Path) -> None:
    """A writer that writes without pause is killed: every complete message is recovered."""
    flushes = 10
    bag = tmp_path / "bag"
    child = subprocess.Popen(
        [sys.executable, "-c", WRITE_FOR_EVER, str(bag)], stdout=subprocess.PIPE, text=True
    )
    assert child.stdout is not None
    lines = [child.stdout.readline() for _ in range(flushes)]
    child.send_signal(signal.SIGKILL)
    lines += child.communicate()[0].splitlines(keepends=True)
    flushed = 1 + max(int(line) for line in lines if line.endswith("\n"))
    with pytest.raises(ParameterError, match="`furuta bag recover` copies what"), Bag(bag):
        pass
    kept = recover(bag, tmp_path / "recovered")["messages"]
    assert times(tmp_path / "recovered") == list(range(kept))
    assert kept >= flushed > 50 * (flushes - 2)
    assert (tmp_path / "recovered" / "parameters.yaml").read_text() == "plant: {}"
    with (bag / "bag_0.mcap").open("rb") as stream:
        messages = NonSeekingReader(stream).iter_messages(log_time_order=False)
        assert [next(messages)[2].log_time for _ in range(kept)] == list(range(kept))


@pytest.mark.parametrize("part", [0.0, 0.6])
def test_recover_truncated(tmp_path: Path, part: float) -> None:
    """A truncated file is refused; the chunks before the cut are recovered, if there is one."""
    file = written(tmp_path / "bag") / "bag_0.mcap"
    with file.open("r+b") as stream:
        stream.truncate(int(part * file.stat().st_size))
    for bag in (file, file.parent):
        with pytest.raises(ParameterError, match="not a readable bag"), Bag(bag):
            pass
    if part == 0.0:
        with pytest.raises(ParameterError, match="no message that can be read"):
            recover(file, tmp_path / "recovered")
        assert not (tmp_path / "recovered").exists()
        return
    recover(file, tmp_path / "recovered")
    kept = times(tmp_path / "recovered")
    assert kept == list(range(len(kept)))
    assert len(kept) >= 50 * int(20 * part - 2)


def test_a_damaged_chunk_is_left_out(tmp_path: Path) -> None:
    """It costs that chunk alone, and is named; no metadata are needed."""
    file = written(tmp_path / "bag") / "bag_0.mcap"
    (file.parent / "metadata.yaml").unlink()
    content = bytearray(file.read_bytes())
    place = content.index((275).to_bytes(8, "little") * 2)  # both times of a message
    content[place - 1] ^= 0xFF
    file.write_bytes(content)
    (problem,) = recover(file.parent, tmp_path / "recovered")["problems"]
    assert "left out a chunk" in problem
    assert times(tmp_path / "recovered") == [k for k in range(1000) if not 250 <= k < 300]


def test_a_full_disk_ends_a_recording(tmp_path: Path) -> None:
    """What was written before can be recovered; closing twice does no harm."""
    writer = BagWriter(tmp_path / "bag", TOPICS, {})
    writer.add(0, 1, DATA)
    writer.flush()
    _, most = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2**16, most))
    try:
        writer.add(0, 2, bytes(2**20))
        with pytest.raises(UserError, match="bag: File too large"):
            writer.close()
        writer.close()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
    assert recover(writer.path, tmp_path / "recovered")["messages"] == 1


@pytest.mark.parametrize("waits", [False, True])
def test_a_recorder_does_not_wait_for_a_slow_disk(
    tmp_path: Path, monkeypatch: Any, waits: bool
) -> None:
    """Until too much is waiting: then it raises an error, or in lock-step it waits."""
    monkeypatch.setattr(module, "LARGEST_BACKLOG", 2**20)
    monkeypatch.setattr(module, "FLUSH_INTERVAL", 0.0)
    disk = threading.Event()
    writer = BagWriter(tmp_path / "bag", TOPICS, {}, waits)
    writer._file._writing = writer._file._thread.submit(lambda: disk.wait() and None)
    writer.add(0, 0, bytes(2**20 - 1000))
    writer.flush()
    writer.add(0, 1, bytes(1000))
    if waits:
        threading.Timer(0.1, disk.set).start()
        writer.flush()
    else:
        with pytest.raises(UserError, match="the disk is too slow"):
            writer.flush()
    disk.set()
    writer.close()
    assert times(writer.path) == [0, 1]


@pytest.mark.parametrize(
    ("plugin", "mode"),
    [
        (None, CompressionMode.NONE),
        (StoragePlugin.SQLITE3, CompressionMode.NONE),
        (StoragePlugin.MCAP, CompressionMode.MESSAGE),
    ],
)
def test_messages_of_a_topic_are_read(
    tmp_path: Path, plugin: StoragePlugin | None, mode: CompressionMode
) -> None:
    """In the order of their times, whoever wrote the bag."""
    bag = tmp_path / "bag"
    bag = written(bag, 400) if plugin is None else written_by_another(bag, plugin, mode)
    with Bag(bag) as opened:
        topic = opened.connections[0]
        messages = list(opened.messages([topic]))
        assert [time for _, time, _ in messages] == times(bag)[::2]
        assert opened.deserialize(messages[0][2], topic.msgtype).data >= 0.0


def test_what_is_no_readable_bag_is_one_line(tmp_path: Path) -> None:
    """Missing, of another kind, without metadata, a sqlite3 file with an open log."""
    bag = written_by_another(tmp_path / "sqlite", StoragePlugin.SQLITE3)
    (tmp_path / "empty").mkdir()
    (tmp_path / "text.mcap").write_text("no bag" * 20)
    for path, words in (
        (tmp_path / "empty", "it has neither metadata.yaml nor a file .mcap or .db3"),
        (tmp_path / "text.mcap", "File magic is invalid"),
    ):
        with pytest.raises(ParameterError, match=words) as error:
            times(path)
        assert "\n" not in str(error.value)
    with pytest.raises(ParameterError, match="sensor_msgs/msg/JointState"):
        read(bag, Mapping())
    with pytest.raises(ParameterError, match=r"`\.recover` of sqlite3"):
        recover(bag, tmp_path / "recovered")
    with closing(sqlite3.connect(bag / "sqlite.db3")) as database:
        database.execute("PRAGMA journal_mode=WAL")
        with database:
            database.execute("UPDATE messages SET timestamp = timestamp + 1")
        for path in (bag, bag / "sqlite.db3"):
            with pytest.raises(ParameterError, match="wal holds messages; `sqlite3 "):
                times(path)


@pytest.mark.parametrize("storage", list(StoragePlugin))
def test_one_file_without_metadata_is_read(storage: StoragePlugin, tmp_path: Path) -> None:
    """Of several files the order is unknown: the error names what makes the metadata anew."""
    bag = written_by_another(tmp_path / "bag", storage)
    expected = times(bag)
    (bag / "metadata.yaml").unlink()
    assert times(bag) == expected
    (file,) = bag.iterdir()
    shutil.copy(file, file.with_stem("bag_1"))
    remedy = "furuta bag recover" if storage is StoragePlugin.MCAP else f"ros2 bag reindex {bag}"
    with pytest.raises(ParameterError, match=f"it has no metadata.yaml .*`{remedy}`"):
        times(bag)


@pytest.mark.parametrize(
    ("encoding", "name", "profile"),
    [("json", "JSON", ""), ("json", "JSON", "ros2"), ("protobuf", "Protobuf", ""),
     ("ros1", "ROS 1", "ros1"), ("cbor", "'cbor'", "")],
)  # fmt: skip
def test_messages_of_another_kind_are_named(
    encoding: str, name: str, profile: str, tmp_path: Path
) -> None:
    """To read them and to recover them; beside messages of ROS 2 only these are recovered."""
    for file, with_ros in ((tmp_path / "foreign.mcap", False), (tmp_path / "both.mcap", True)):
        with file.open("wb") as stream:
            writer = McapWriter(stream)
            writer.start(profile)
            schema = writer.register_schema("a.B", "jsonschema", b"{}")
            channels = [writer.register_channel("/other", encoding, schema)]
            if with_ros:
                float64 = writer.register_schema("std_msgs/msg/Float64", "ros2msg", b"float64 data")
                channels.append(writer.register_channel("/a", "cdr", float64))
            for time in range(10):
                for channel in channels:
                    writer.add_message(channel, time, DATA, time)
            writer.finish()
    with pytest.raises(ParameterError) as error:
        read_axis(tmp_path / "foreign.mcap")
    assert str(error.value).endswith(f"not a readable bag: its messages are {name}, not ROS 2")
    with pytest.raises(ParameterError, match=f"/other, whose messages are {name}, not ROS 2"):
        recover(tmp_path / "foreign.mcap", tmp_path / "recovered")
    result = recover(tmp_path / "both.mcap", tmp_path / "recovered")
    assert result["problems"] == [
        f"both.mcap: left out /other, whose messages are {name}, not ROS 2"
    ]
    assert times(tmp_path / "recovered") == list(range(10))


def test_a_bag_of_ros_1_is_converted_by_what_the_error_names(tmp_path: Path) -> None:
    """The command comes with rosbags; the bag that it makes has the same messages."""
    path, types = tmp_path / "robot 1.bag", get_typestore(Stores.ROS1_NOETIC)
    make = types.types.__getitem__
    with Ros1Writer(path) as writer:
        states = writer.add_connection("/js", "sensor_msgs/msg/JointState", typestore=types)
        for time in range(1, 100):
            header = make("std_msgs/msg/Header")(
                0, make("builtin_interfaces/msg/Time")(0, time), ""
            )
            numbers = np.array([0.1 * time]), np.zeros(0), np.ones(1)
            message = make(states.msgtype)(header, ["elbow"], *numbers)
            writer.write(states, time, types.serialize_ros1(message, states.msgtype))
    for reads in (read_axis, Bag.__enter__):
        with pytest.raises(ParameterError, match="is a ROS 1 bag; `rosbags-convert") as error:
            reads(path if reads is read_axis else Bag(path))
    command = shlex.split(str(error.value).split("`")[1])
    subprocess.run(command, check=True)
    with Bag(tmp_path / "robot 1_ros2") as converted:
        last = list(converted.messages())[-1]
        assert converted.deserialize(last[2], last[0].msgtype).position == [pytest.approx(9.9)]
    assert last[1] == 99


BEGIN, BOOT = 1_700_000_000_000_000_000, 7_000_000_000
STEP = 10_000_000


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
    np.testing.assert_allclose(found.command_time, found.time - 1e-9 * STEP, atol=1e-9)
    assert "begins anew after 6.28319" in found.findings[-1]
    assert set(read_axis(bag, joint="b", command="command").command) == {7.0}
    for options, words in (
        ({}, "any of a, b may be the axis; name it with --joint"),
        ({"joint": "c"}, "no joint c; it has a, b"),
        ({"position": "b"}, "a bag has no columns"),
        ({"joint": "b", "command": "nothing"}, "no command nothing"),
    ):
        with pytest.raises(ParameterError, match=words):
            read_axis(bag, **options)


@pytest.mark.parametrize("data", [[], [1.0, 2.0]])
def test_a_command_of_none_or_several_numbers_is_not_guessed(data: list[float]) -> None:
    """An effort controller's command has one for each joint."""
    with pytest.raises(ParameterError, match=f"needs one number, a message has {len(data)}"):
        Series().add_number(0, SimpleNamespace(data=data), "/effort_controller/commands")


def test_joints_of_several_publishers(tmp_path: Path) -> None:
    """Their messages alternate, and one has no stamps: a joint has the times of its own ones."""
    messages: list[Any] = []
    for k in range(100):
        at = BEGIN + k * STEP
        messages.append((at, at - STEP // 4, {"a": (0.1 * k, 0.0, 1.0 * k)}))
        messages.append((at + STEP // 2, 0, {"b": (0.2 * k, 0.0, 2.0 * k)}))
    bag = joint_bag(tmp_path / "bag", messages)
    for name, size in (("a", 0.1), ("b", 0.2)):
        found = read_axis(bag, joint=name)
        assert (found.joint, found.findings) == (name, ())
        np.testing.assert_allclose(found.time, 0.01 * np.arange(100), atol=1e-9)
        np.testing.assert_allclose(found.measured[:, 0], size * np.arange(100))
        np.testing.assert_allclose(found.command, 10.0 * size * np.arange(100))


STATES = "std_msgs/Header header\nstring[] joint_names\n"
VALUE, DYNAMIC, TRAJECTORY = (
    f"control_msgs/msg/{name}"
    for name in ("InterfaceValue", "DynamicJointState", "JointTrajectoryControllerState")
)
USUAL = "sensor_msgs/msg/JointState"
SQLITE, MCAP = StoragePlugin.SQLITE3, StoragePlugin.MCAP


def control_bag(path: Path, plugin: StoragePlugin, points: dict[str, list[float]]) -> Path:
    """Joint ``b`` moves by 0.1 rad a sample under the torque k; beside it a sensor, and ``a``.

    Two topics of the usual type have ``b`` without effort, and ``c``.
    ``points`` are those of a trajectory controller by name: factors on position and effort of b.
    Without any, the states are dynamic ones.
    """
    types = get_typestore(Stores.ROS2_JAZZY)
    fields = "\n".join(f"trajectory_msgs/JointTrajectoryPoint {name}" for name in points)
    types.register(get_types_from_msg("string[] interface_names\nfloat64[] values", VALUE))
    types.register(get_types_from_msg(f"{STATES}InterfaceValue[] interface_values", DYNAMIC))
    types.register(get_types_from_msg(f"{STATES}{fields}", TRAJECTORY))
    make = types.types.__getitem__
    kind, none = TRAJECTORY if points else DYNAMIC, np.zeros(0)
    point = make("trajectory_msgs/msg/JointTrajectoryPoint")
    still = make("builtin_interfaces/msg/Duration")(0, 0)
    with Writer(path, version=9, storage_plugin=plugin) as writer:
        topic, right, left = (
            writer.add_connection(name, each, typestore=types)
            for name, each in (("/states", kind), ("/right", USUAL), ("/left", USUAL))
        )
        for k in range(50):
            time = make("builtin_interfaces/msg/Time")(*divmod(BEGIN + k * STEP, 10**9))
            header, names = make("std_msgs/msg/Header")(time, ""), ["sensor", "a", "b"]
            rows = [
                [np.array([0.0, 9.0, factor * k])[: 3 * bool(factor)] for factor in factors]
                for factors in points.values()
            ]
            content = [point(row[0], none, none, row[1], still) for row in rows]
            if not points:
                interfaces = {"force.z": [1.0], "position": [9.0], "effort position": [k, 0.1 * k]}
                values = [
                    make(VALUE)(words.split(), np.array(series, float))
                    for words, series in interfaces.items()
                ]
                content = [values]
            message = make(kind)(header, names, *content)
            writer.write(topic, BEGIN + k * STEP, types.serialize_cdr(message, kind))
            for connection, name, effort in ((right, "b", none), (left, "c", np.ones(1))):
                message = make(USUAL)(header, [name], np.array([-0.2 * k]), none, effort)
                writer.write(connection, BEGIN + k * STEP, types.serialize_cdr(message, USUAL))
    return path


@pytest.mark.parametrize(
    ("points", "commanded"),
    [
        ({}, False),
        ({"reference": [5.0, 5.0], "feedback": [0.1, 0.0], "output": [0.0, 1.0]}, True),
        ({"feedback": [0.1, 1.0], "output": [0.0, 7.0]}, False),
        ({"desired": [5.0, 0.0], "actual": [0.1, 1.0]}, False),
    ],
)
def test_joint_states_of_controllers(
    tmp_path: Path, points: dict[str, list[float]], commanded: bool
) -> None:
    """Position and effort, which may be the controller's output; by the bag's own definitions."""
    bags = [control_bag(tmp_path / plugin.name, plugin, points) for plugin in (SQLITE, MCAP)]
    for bag in bags:
        found = read_axis(bag, joint="b")
        np.testing.assert_allclose(found.time, 0.01 * np.arange(50), atol=1e-9)
        np.testing.assert_allclose(found.measured[:, 0], 0.1 * np.arange(50))
        np.testing.assert_allclose(found.command, np.arange(50.0))
        assert f"{bag.name}: position of b from /states" in found.findings[0]
        assert ("effort of b: what its controller" in found.findings[-1]) == commanded
        of_rig = read(bag, Mapping("b", "a", command="effort", states="states"))
        np.testing.assert_allclose(of_rig.measured[:, 0], found.measured[:, 0])
        assert of_rig.findings == found.findings[1:]
        np.testing.assert_allclose(read_axis(bag, joint="c").measured[:, 0], -0.2 * np.arange(50))
        with pytest.raises(ParameterError, match="on each of /right, /left; name the joint"):
            read_axis(bag)
        with pytest.raises(ParameterError, match="no joint d; it has b, c, "):
            read_axis(bag, joint="d")
    with closing(sqlite3.connect(next(bags[0].glob("*.db3")))) as database, database:
        database.execute("DELETE FROM message_definitions")
    with pytest.raises(ParameterError, match="SQLITE3 does not define the type control_msgs/msg"):
        read_axis(bags[0], joint="b")
