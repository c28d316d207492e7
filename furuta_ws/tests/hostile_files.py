"""Files made to mislead whoever reads them: each small, each claiming or naming too much."""

import os
import sqlite3
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import zstandard
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from furuta_recordings.bags.metadata import BagTopic
from furuta_recordings.bags.writer import BagWriter

MAGIC = b"\x89MCAP0\r\n"
RECORD_HEAD = struct.Struct("<BQ")

JOINT_STATES = "sensor_msgs/msg/JointState"
TYPES = get_typestore(Stores.ROS2_JAZZY)
BILLION = 10**9
# What hostile files must not make anybody open.
SECRET = "secret"


def joint_state(k: int) -> bytes:
    header = TYPES.types["std_msgs/msg/Header"](
        stamp=TYPES.types["builtin_interfaces/msg/Time"](sec=0, nanosec=k * 1000), frame_id=""
    )
    numbers = np.array([0.1, 0.2])
    message = TYPES.types[JOINT_STATES](
        header, ["arm", "pendulum"], numbers, numbers, np.array([0.0])
    )
    return bytes(TYPES.serialize_cdr(message, JOINT_STATES))


def sound_bag(path: Path, messages: list[bytes] | None = None) -> Path:
    """A bag of ours with measurements and commands."""
    types = {"/measurement": JOINT_STATES, "/command": "std_msgs/msg/Float64"}
    topics = [
        BagTopic(name, each, TYPES.generate_msgdef(each, ros_version=2)[0], "")
        for name, each in types.items()
    ]
    writer = BagWriter(path, topics, {"parameters.yaml": "plant: {ros__parameters: {}}\n"})
    for k, data in enumerate(messages or [joint_state(k) for k in range(10)]):
        writer.add(0, k, data)
        writer.add(1, k, b"\0\1\0\0" + bytes(8))
    writer.close()
    return path


def sqlite_bag(path: Path) -> Path:
    with Writer(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connection = writer.add_connection("/measurement", JOINT_STATES, typestore=TYPES)
        for k in range(10):
            writer.write(connection, k, joint_state(k))
    return path


# -- bags whose metadata or files lead outside -------------------------------------------------


def _renamed_in_metadata(bag: Path, name: str) -> Path:
    metadata = bag / "metadata.yaml"
    metadata.write_text(metadata.read_text().replace(f"{bag.name}_0.db3", name))
    return bag


def parent_path(path: Path) -> Path:
    """metadata.yaml names a file by a path with .."""
    sound_bag(path.parent / SECRET)
    return _renamed_in_metadata(sound_bag(path), f"../{SECRET}/{SECRET}_0.db3")


def linked_file(path: Path) -> Path:
    """The data file is a link to one outside."""
    outside = sound_bag(path.parent / SECRET) / f"{SECRET}_0.db3"
    file = sound_bag(path) / f"{path.name}_0.db3"
    file.unlink()
    file.symlink_to(outside)
    return path


def escaped_name(path: Path) -> Path:
    """sqlite3 takes the file's name for an address, in which %2f is a slash."""
    outside = sqlite_bag(path.parent / SECRET) / f"{SECRET}.db3"
    name = f"..%2f{SECRET}%2f{outside.name}"
    bag = sqlite_bag(path)
    (bag / f"{path.name}.db3").rename(bag / name)
    metadata = bag / "metadata.yaml"
    metadata.write_text(metadata.read_text().replace(f"{path.name}.db3", name))
    return bag


def pipe_as_data(path: Path) -> Path:
    file = sound_bag(path) / f"{path.name}_0.db3"
    file.unlink()
    os.mkfifo(file)
    return path


# -- YAML --------------------------------------------------------------------------------------


def metadata_of(text: str) -> Callable[[Path], Path]:
    def make(path: Path) -> Path:
        (sound_bag(path) / "metadata.yaml").write_text(text)
        return path

    return make


# -- MCAP --------------------------------------------------------------------------------------


def record(opcode: int, content: bytes) -> bytes:
    return RECORD_HEAD.pack(opcode, len(content)) + content


def text(value: str | bytes) -> bytes:
    data = value.encode() if isinstance(value, str) else value
    return struct.pack("<I", len(data)) + data


def mcap_file(chunks: list[tuple[str, bytes, int, int]]) -> bytes:
    """A file with chunks (compression, data, claimed size, start time)."""
    described = record(
        3,
        struct.pack("<H", 1)
        + text("std_msgs/msg/Float64")
        + text("ros2msg")
        + text("float64 data"),
    )
    described += record(4, struct.pack("<HH", 1, 1) + text("/command") + text("cdr") + text(b""))
    data = MAGIC + record(1, text("ros2") + text("hostile"))
    indexes = b""
    for compression, content, size, start in chunks:
        head = struct.pack("<QQQI", start, start + 10, size, 0)
        chunk = record(6, head + text(compression) + struct.pack("<Q", len(content)) + content)
        place = struct.pack("<QQQQ", start, start + 10, len(data), len(chunk))
        offsets = struct.pack("<IHQ", 10, 1, len(data) + len(chunk))
        sizes = struct.pack("<QQ", len(content), size)
        index = place + offsets + struct.pack("<Q", 31) + text(compression) + sizes
        indexes += record(8, index)
        data += chunk + record(7, struct.pack("<HIQQ", 1, 16, start, 0))
    data += record(15, bytes(4))
    statistics = struct.pack("<QHIIIIQQI", 1, 1, 1, 0, 0, len(chunks), 0, 10, 10)
    statistics += struct.pack("<HQ", 1, 1)
    summary = described + record(11, statistics) + indexes
    return data + summary + record(2, struct.pack("<QQI", len(data), 0, 0)) + MAGIC


def file_of(content: Callable[[], bytes]) -> Callable[[Path], Path]:
    def make(path: Path) -> Path:
        file = path.with_suffix(".mcap")
        file.write_bytes(content())
        return file

    return make


def compressed(compression: str, size: int) -> bytes:
    zeros = bytes(2**20)
    compressor = zstandard.ZstdCompressor(level=3).compressobj()
    parts = [compressor.compress(zeros) for _ in range(size // 2**20)]
    return b"".join([*parts, compressor.flush()])


def bomb(compression: str, size: int, claimed: int | None = None) -> Callable[[Path], Path]:
    return file_of(
        lambda: mcap_file(
            [(compression, compressed(compression, size), size if claimed is None else claimed, 0)]
        )
    )


def long_record() -> bytes:
    return MAGIC + record(1, text("ros2") + text("x")) + RECORD_HEAD.pack(5, BILLION) + bytes(100)


def claimed_array(path: Path) -> Path:
    """A message claims 10⁹ names of joints."""
    data = bytearray(joint_state(0))
    place = data.index(struct.pack("<II", 2, 4))
    data[place : place + 4] = BILLION.to_bytes(4, "little")
    return sound_bag(path, [bytes(data)] * 10)


def fixed_array(path: Path) -> Path:
    """A type with an array of 10⁹ messages."""
    definition = f"Inner[{BILLION}] data\n{'=' * 80}\nMSG: evil_msgs/Inner\nuint8 x\n"
    topics = [
        BagTopic("/measurement", JOINT_STATES, TYPES.generate_msgdef(JOINT_STATES)[0], ""),
        BagTopic("/command", "evil_msgs/msg/Command", definition, ""),
    ]
    writer = BagWriter(path, topics, {})
    writer.add(0, 0, joint_state(0))
    writer.add(1, 0, b"\0\1\0\0" + bytes(8))
    writer.close()
    return path


# -- sqlite3 -----------------------------------------------------------------------------------


def altered_sqlite(*statements: str) -> Callable[[Path], Path]:
    def make(path: Path) -> Path:
        bag = sqlite_bag(path)
        connection = sqlite3.connect(bag / f"{path.name}.db3")
        for statement in statements:
            connection.execute(statement)
        connection.commit()
        connection.close()
        return bag

    return make


ENDLESS = (
    "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) "
    "SELECT i AS id, 1 AS topic_id, i AS timestamp, x'00010000' AS data FROM n"
)
endless_view = altered_sqlite("DROP TABLE messages", f"CREATE VIEW messages AS {ENDLESS}")
