"""Opens sqlite3 files of bags: plain tables only, with what a write-ahead log holds."""

import os
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path
from urllib.parse import quote

from furuta_recordings.bags.limits import DamagedError

_TABLES = ("topics", "messages", "message_definitions", "schema", "metadata")
# Files that sqlite3 reads with a file of the same name.
_COMPANIONS = ("-wal", "-shm", "-journal")


def check_sqlite(file: Path) -> None:
    """Refuse what is no plain table, and a path that rosbags would misread.

    Raises:
        DamagedError: The file is not what it claims.
    """
    if set("%?#") & set(str(file)):
        raise DamagedError("the path of a .db3 file must not contain %, ? or #")
    with open_sqlite(file):
        pass


def has_log(file: Path) -> bool:
    """Whether a recorder is still writing the file, or was killed: rosbags ignores the log."""
    return file.with_name(f"{file.name}-wal").exists()


def copy_whole(file: Path, target: Path) -> None:
    """Copy the file with what its write-ahead log holds."""
    with open_sqlite(file) as source, closing(sqlite3.connect(target)) as copy:
        source.backup(copy)


@contextmanager
def open_sqlite(file: Path) -> Iterator[sqlite3.Connection]:
    """Open a bag file for reading; text that is no UTF-8 is replaced."""
    for ending in _COMPANIONS:
        companion = file.with_name(file.name + ending)
        if os.path.lexists(companion) and (companion.is_symlink() or not companion.is_file()):
            raise DamagedError(f"{companion.name} is not a regular file")
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
            raise DamagedError(f"{name} is not a plain table")
