"""Finds and opens the files of a bag, and refuses those that are not in it or no plain tables."""

import os
import sqlite3
import stat
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple
from urllib.parse import quote

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.limits import MOST_TOPICS
from furuta_recordings.bags.metadata import METADATA_FILE, PARAMETERS_FILE, SECTION, VERSION
from furuta_ros.yaml_files import read_yaml

_TABLES = ("topics", "messages", "message_definitions", "schema", "metadata")
# What the columns that are read must hold: sqlite3 keeps a value of any type in any column.
_TEXTS = ("name", "type", "serialization_format", "offered_qos_profiles", "type_description_hash")
_DEFINITION = ("topic_type", "encoding", "encoded_message_definition", "type_description_hash")
_TYPES = {
    "schema": {"schema_version": "integer"},
    "topics": {"id": "integer", **dict.fromkeys(_TEXTS, "text")},
    "message_definitions": dict.fromkeys(_DEFINITION, "text"),
    "messages": {"topic_id": "integer", "timestamp": "integer", "data": "blob"},
}


class BagFiles(NamedTuple):
    """The data files of a bag in their order, and topics (name, type) that its metadata names."""

    files: list[Path]
    topics: tuple[tuple[str, str], ...] = ()


def bag_files(bag: Path) -> BagFiles:
    """The files of a bag: those that its metadata.yaml names, or the file itself.

    Raises:
        ParameterError: A file is missing or is not a regular file in the bag, metadata.yaml cannot
            be read, or rosbag2 has compressed the bag.
    """
    if not bag.is_dir():
        if not bag.is_file():
            raise ParameterError("it is a device or pipe")
        return BagFiles([bag])
    content = read_yaml(file_in(bag, METADATA_FILE), "metadata")
    about = _mapping(content, SECTION)
    version = about.get("version")
    if not isinstance(version, int) or version > VERSION:
        raise ParameterError(f"its metadata has version {version}, at most {VERSION} is known")
    mode = str(about.get("compression_mode") or "none").lower()
    if mode != "none":
        raise ParameterError(f"each {mode} is compressed: write it anew with `ros2 bag convert`")
    names = [str(name) for name in _list(about, "relative_file_paths")]
    if len(set(names)) < len(names):
        raise ParameterError("its metadata names a file twice")
    return BagFiles([file_in(bag, name) for name in names], tuple(_topics(about)))


def file_in(bag: Path, name: str) -> Path:
    """A regular file of a bag; ``name`` as its metadata gives it.

    Early rosbag2 put the name of the bag before that of the file.
    """
    path = PurePosixPath(name)
    if path.is_absolute() or ".." in path.parts or "\0" in name:
        raise ParameterError(f"its metadata names {name}, which is outside the bag")
    file = bag / path.name
    if not os.path.lexists(file):
        raise ParameterError(f"it has no file {path.name}")
    if not file.resolve().is_relative_to(bag.resolve()):
        raise ParameterError(f"{path.name} is a link to a file outside the bag")
    if not stat.S_ISREG(file.stat().st_mode):
        raise ParameterError(f"{path.name} is not a regular file")
    return file


def parameter_file_of(bag: Path) -> Path | None:
    """The parameter file beside the data, if there is one."""
    if not os.path.lexists(bag / PARAMETERS_FILE):
        return None
    try:
        return file_in(bag, PARAMETERS_FILE)
    except ParameterError as error:
        raise ParameterError(f"{bag}: {error}") from None


def _topics(about: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    described = _list(about, "topics_with_message_count")
    if len(described) > MOST_TOPICS:
        raise ParameterError(f"its metadata has more than {MOST_TOPICS} topics")
    for topic in described:
        about_topic = _mapping(topic, "topic_metadata")
        yield str(about_topic.get("name")), str(about_topic.get("type"))


def _list(about: Mapping[str, Any], name: str) -> list[Any]:
    content = about.get(name) or []
    if not isinstance(content, list):
        raise ParameterError(f"{name} in its metadata is not a list")
    return content


def _mapping(content: Any, name: str) -> Mapping[str, Any]:
    part = content.get(name) if isinstance(content, Mapping) else None
    if not isinstance(part, Mapping):
        raise ParameterError(f"its metadata has no {name}")
    return part


@contextmanager
def whole_files(files: list[Path]) -> Iterator[list[Path]]:
    """The files as rosbags reads them: it ignores what a write-ahead log holds.

    A log is there while a recorder writes the file, and after it was killed.

    Raises:
        ParameterError: A file is not what it claims.
    """
    with TemporaryDirectory(prefix="furuta-bag-") as directory:
        yield [_whole(file, Path(directory)) for file in files]


def _whole(file: Path, directory: Path) -> Path:
    """The file, or a copy with the content of its log."""
    if file.suffix != ".db3":
        return file
    if set("%?#") & set(str(file)):  # rosbags would misread it
        raise ParameterError("the path of a .db3 file must not contain %, ? or #")
    with open_sqlite(file) as source:
        check_values(source)
        if not file.with_name(f"{file.name}-wal").exists():
            return file
        with closing(sqlite3.connect(directory / file.name)) as copy:
            source.backup(copy)
    return directory / file.name


@contextmanager
def open_sqlite(file: Path) -> Iterator[sqlite3.Connection]:
    """Open a bag file for reading; text that is no UTF-8 is replaced."""
    for ending in ("-wal", "-shm", "-journal"):  # which sqlite3 reads with the file
        companion = file.with_name(file.name + ending)
        if os.path.lexists(companion) and (companion.is_symlink() or not companion.is_file()):
            raise ParameterError(f"{companion.name} is not a regular file")
    # The name is part of an address, in which %2e stands for a dot.
    address = f"file:{quote(str(file.absolute()))}?mode=ro"
    with closing(sqlite3.connect(address, uri=True)) as connection:
        connection.text_factory = partial(str, encoding="utf-8", errors="replace")
        _check_tables(connection)
        yield connection


def _check_tables(connection: sqlite3.Connection) -> None:
    """Accept plain tables with stored columns only: a view can stand for rows without end."""
    for name, kind, sql in connection.execute("SELECT name, type, sql FROM sqlite_master"):
        if name not in _TABLES:
            continue
        columns = connection.execute("SELECT hidden FROM pragma_table_xinfo(?)", [name])
        virtual = str(sql).upper().split()[:2] == ["CREATE", "VIRTUAL"]
        if kind != "table" or virtual or any(hidden for (hidden,) in columns):
            raise ParameterError(f"{name} is not a plain table")


def check_values(connection: sqlite3.Connection) -> None:
    """Raise :class:`ParameterError` if a column holds a value of another type than it must."""
    for table, types in _TYPES.items():
        columns = connection.execute("SELECT name FROM pragma_table_info(?)", [table]).fetchall()
        for column in (name for (name,) in columns if name in types):
            query = f"SELECT typeof({column}) FROM {table} WHERE typeof({column}) != ? LIMIT 1"
            for (found,) in connection.execute(query, [types[column]]):
                raise ParameterError(f"{table}.{column} holds {found}, must be {types[column]}")
