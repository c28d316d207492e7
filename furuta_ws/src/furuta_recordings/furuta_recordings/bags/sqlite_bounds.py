"""Opens sqlite3 files of bags, after a check that they hold what they claim.

A view can stand for rows without end, a generated column for values of a gigabyte, and pages that
refer to each other for more rows than the file has bytes.
"""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path
from urllib.parse import quote

from furuta_recordings.bags.bounds import LARGEST_CHUNK, LARGEST_TOPICS, MOST_TOPICS, SMALLEST_ROW
from furuta_recordings.bags.damaged_message import DamagedError

_TABLES = ("topics", "messages", "message_definitions", "schema", "metadata")


@contextmanager
def open_sqlite(file: Path) -> Iterator[sqlite3.Connection]:
    """Open a bag file for reading; text that is no UTF-8 is replaced."""
    _check_companions(file)
    # The name is part of an address, in which %2e stands for a dot.
    address = f"file:{quote(str(file.absolute()))}?mode=ro"
    with closing(sqlite3.connect(address, uri=True)) as connection:
        connection.text_factory = partial(str, encoding="utf-8", errors="replace")
        _check_tables(connection)
        yield connection


def check_sqlite(file: Path) -> None:
    """Raise :class:`DamagedError` if the file claims more than it may hold."""
    if set("%?#") & set(str(file)):
        raise DamagedError("the path of a .db3 file must not contain %, ? or #")
    with open_sqlite(file) as connection:
        _check_topics(connection)
        _check_messages(connection, file.stat().st_size)


def _check_companions(file: Path) -> None:
    """sqlite3 reads these files with the file itself."""
    for ending in ("-wal", "-shm", "-journal"):
        companion = file.with_name(file.name + ending)
        if os.path.lexists(companion) and (companion.is_symlink() or not companion.is_file()):
            raise DamagedError(f"{companion.name} is not a regular file")


def _check_tables(connection: sqlite3.Connection) -> None:
    """Accept plain tables with stored columns only."""
    for name, kind, sql in connection.execute("SELECT name, type, sql FROM sqlite_master"):
        if name not in _TABLES:
            continue
        columns = connection.execute("SELECT hidden FROM pragma_table_xinfo(?)", [name])
        virtual = str(sql).upper().split()[:2] == ["CREATE", "VIRTUAL"]
        if kind != "table" or virtual or any(hidden for (hidden,) in columns):
            raise DamagedError(f"{name} is not a plain table")


def _check_topics(connection: sqlite3.Connection) -> None:
    topics = connection.execute(f"SELECT id, * FROM topics LIMIT {MOST_TOPICS + 1}")
    numbers, size = [], 0
    for number, *columns in topics:
        numbers.append(number)
        size += sum(len(each) for each in columns if isinstance(each, (str, bytes)))
        if len(numbers) > MOST_TOPICS or size > LARGEST_TOPICS:
            raise DamagedError(f"more than {MOST_TOPICS} topics, or {LARGEST_TOPICS} bytes of them")
    if len(set(numbers)) < len(numbers):
        raise DamagedError("two topics with the same number")


def _check_messages(connection: sqlite3.Connection, file_size: int) -> None:
    """Check number and size of messages, as the table and its index on time give them."""
    most = file_size // SMALLEST_ROW
    rows = f"(SELECT data FROM messages NOT INDEXED LIMIT {most + 1})"
    ((count, total, largest),) = connection.execute(
        f"SELECT count(*), total(length(data)), max(length(data)) FROM {rows}"
    )
    in_order = f"(SELECT timestamp FROM messages ORDER BY timestamp LIMIT {most + 1})"
    ((indexed,),) = connection.execute(f"SELECT count(*) FROM {in_order}")
    if max(count, indexed) > most or total > file_size:
        raise DamagedError(f"more messages than fit into a file of {file_size} bytes")
    if (largest or 0) > LARGEST_CHUNK:
        raise DamagedError(f"a message of {largest} bytes, at most {LARGEST_CHUNK} are allowed")
