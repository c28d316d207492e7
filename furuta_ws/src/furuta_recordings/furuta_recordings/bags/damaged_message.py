"""A message found in a damaged file, and the error at the place where reading must stop."""

from __future__ import annotations

from typing import NamedTuple

from furuta_recordings.bags.bounds import MOST_PROBLEMS
from furuta_recordings.bags.mcap_records import BagTopic


class FoundMessage(NamedTuple):
    """A message with its topic, its time [ns] and its serialized content."""

    topic: BagTopic
    time: int
    data: bytes


class DamagedError(Exception):
    """A file or record cannot be read; the text is the reason."""


def note(problems: list[str], problem: str) -> None:
    """Add a problem to those found so far, unless there are very many."""
    if len(problems) == MOST_PROBLEMS:
        problem = "further problems are not listed"
    if len(problems) <= MOST_PROBLEMS:
        problems.append(problem)
