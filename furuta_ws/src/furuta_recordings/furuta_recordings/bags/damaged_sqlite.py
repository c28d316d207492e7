"""Reads messages from sqlite3 bag files that may be damaged."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from furuta_recordings.bags.bounds import MOST_TOPICS, SMALLEST_ROW
from furuta_recordings.bags.damaged_message import FoundMessage, note
from furuta_recordings.bags.mcap_records import BagTopic
from furuta_recordings.bags.sqlite_bounds import open_sqlite


def sqlite_messages(file: Path, problems: list[str]) -> Iterator[FoundMessage]:
    """All readable messages; a note on each unusable row goes to ``problems``."""
    with open_sqlite(file) as connection:
        topics = {
            number: BagTopic(str(name), str(type_name), "", "")
            for number, name, type_name in connection.execute(
                f"SELECT id, name, type FROM topics LIMIT {MOST_TOPICS}"
            )
        }
        most = file.stat().st_size // SMALLEST_ROW
        for number, time, data in connection.execute(
            f"SELECT topic_id, timestamp, data FROM messages ORDER BY id LIMIT {most}"
        ):
            if number in topics and isinstance(data, bytes) and _is_time(time):
                yield FoundMessage(topics[number], time, data)
            else:
                note(problems, f"{file.name}: left out a damaged message")


def _is_time(value: object) -> bool:
    return isinstance(value, int) and 0 <= value < 2**63
