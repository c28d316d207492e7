"""Bounds within which bags are read, so that a damaged or hostile one costs little.

A bag that keeps them is read with less than 1 GiB of memory, in a time that is proportional to the
size of its files. Bags of rosbag2 and of Foxglove's writers stay far below them.
"""

from __future__ import annotations

from typing import Final

# Largest chunk of an MCAP file, and largest message, after decompression [bytes].
LARGEST_CHUNK: Final = 2**25
# Most bytes of chunks whose times overlap, which are in memory together.
LARGEST_OVERLAP: Final = 2**26
# Largest decompressed size, as a multiple of the compressed one; small data may be larger [bytes].
# Recordings of a rig shrink to a tenth.
LARGEST_EXPANSION: Final = 100
SMALL: Final = 2**16
# Largest description of a message type or topic [bytes], of all topics together, and most topics.
LARGEST_DESCRIPTION: Final = 2**18
LARGEST_TOPICS: Final = 2**20
MOST_TOPICS: Final = 10_000
# Smallest record of a message in an MCAP file [bytes].
SMALLEST_MESSAGE: Final = 31
# Smallest row of a sqlite3 table [bytes]: more rows than fit into the file are none.
SMALLEST_ROW: Final = 4
# Most problems that a recovery lists.
MOST_PROBLEMS: Final = 100


def largest_expanded(compressed: int) -> int:
    """Largest size [bytes] that data of ``compressed`` [bytes] may have after decompression."""
    return max(SMALL, LARGEST_EXPANSION * compressed)
