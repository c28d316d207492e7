"""A message found in a damaged file, and the error at the place where reading must stop."""

from __future__ import annotations

from typing import NamedTuple

from furuta_recordings.bags.mcap_records import BagTopic


class FoundMessage(NamedTuple):
    """A message with its topic, its time [ns] and its serialized content."""

    topic: BagTopic
    time: int
    data: bytes


class DamagedError(Exception):
    """A file or record cannot be read; the text is the reason."""
