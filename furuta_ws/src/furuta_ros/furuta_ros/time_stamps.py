"""Time stamps in nanoseconds, of ROS messages and of messages read from bags."""

from typing import Any, Final

NANOSECONDS: Final = 1_000_000_000
# Time between two samples [ns] from which the later one begins anew: longer than any sample time
# and any pause of a loaded machine that the loop rides out.
NEW_START_AFTER: Final = 150_000_000
# No sample has this stamp [ns].
NEVER: Final = -(2**62)
MOST_SECONDS: Final = 1e6  # of a simulation [s]


def stamp_nanoseconds(message: Any) -> int:
    """The time stamp in the message's header [ns]."""
    stamp = message.header.stamp
    return int(stamp.sec * NANOSECONDS + stamp.nanosec)


def starts_anew(interval: int) -> bool:
    """Whether the sample that comes an ``interval`` [ns] after another one does not continue it.

    So it is after a reset of the rig, and when another plant or a replay takes over.
    """
    return not 0 <= interval <= NEW_START_AFTER
