"""Reads messages from sqlite3 bag files that may be damaged."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from furuta_recordings.bags.damaged_message import FoundMessage
from furuta_recordings.bags.mcap_records import BagTopic


def sqlite_messages(file: Path, problems: list[str]) -> Iterator[FoundMessage]:
    """All readable messages; a note on each unusable row goes to ``problems``."""
    connection = sqlite3.connect(f"file:{file}?mode=ro", uri=True)
    connection.text_factory = partial(str, encoding="utf-8", errors="replace")
    try:
        topics = {
            number: BagTopic(str(name), str(type_name), "", "")
            for number, name, type_name in connection.execute("SELECT id, name, type FROM topics")
        }
        for number, time, data in connection.execute(
            "SELECT topic_id, timestamp, data FROM messages ORDER BY id"
        ):
            if number in topics and isinstance(data, bytes) and _is_time(time):
                yield FoundMessage(topics[number], time, data)
            else:
                problems.append(f"{file.name}: left out a damaged message")
    finally:
        connection.close()


def _is_time(value: object) -> bool:
    return isinstance(value, int) and 0 <= value < 2**63
