"""Time stamps in nanoseconds, of ROS messages and of messages read from bags."""

from __future__ import annotations

from typing import Any, Final

NANOSECONDS: Final = 1_000_000_000


def stamp_nanoseconds(message: Any) -> int:
    """The time stamp in the message's header [ns]."""
    stamp = message.header.stamp
    return int(stamp.sec * NANOSECONDS + stamp.nanosec)
