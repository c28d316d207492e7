"""What the user knows about a recording."""

from __future__ import annotations

from typing import NamedTuple

ZEROS = ("auto", "upright", "hanging")
ANGLE_UNITS = ("auto", "rad", "deg")


class Options(NamedTuple):
    """Options of an identification.

    ``zero`` is where the pendulum's angle is 0 (auto, upright, hanging), ``window`` the length of
    the segments that are simulated [s] (None: automatic), ``angles`` the unit of the angles (auto,
    rad, deg), ``command_scale`` the voltage that a command of 1 stands for [V].
    """

    zero: str = "auto"
    window: float | None = None
    angles: str = "auto"
    command_scale: float = 1.0
