"""Limits within which bags are read, and the error at the place where reading must stop.

The libraries that read bags decompress without a limit, while a few kilobytes can stand for
gigabytes. Bags of rosbag2 and of Foxglove's writers stay far below these limits.
"""

from typing import Final

# Largest chunk of an MCAP file, and largest message, after decompression [bytes].
LARGEST_CHUNK: Final = 2**25
# Largest decompressed size, as a multiple of the compressed one; small data may be larger [bytes].
# Recordings of a rig shrink to a tenth.
LARGEST_EXPANSION: Final = 100
SMALL: Final = 2**16
# Largest description of a message type [bytes], and most topics.
LARGEST_DESCRIPTION: Final = 2**18
MOST_TOPICS: Final = 10_000
# Most problems that a recovery lists.
MOST_PROBLEMS: Final = 100


class DamagedError(Exception):
    """A file or record cannot be read; the text is the reason."""


def largest_expanded(compressed: int) -> int:
    """Largest size [bytes] that data of ``compressed`` [bytes] may have after decompression."""
    return max(SMALL, LARGEST_EXPANSION * compressed)


def note(problems: list[str], problem: str) -> None:
    """Add a problem to those noted so far, unless there are very many."""
    if len(problems) == MOST_PROBLEMS:
        problem = "further problems are not listed"
    if len(problems) <= MOST_PROBLEMS:
        problems.append(problem)
