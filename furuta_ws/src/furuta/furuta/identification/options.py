"""What the user knows about a recording."""

from collections.abc import Callable
from typing import NamedTuple

ZEROS = ("auto", "upright", "hanging")
ANGLE_UNITS = ("auto", "rad", "deg")
# The direction of the pendulum's angle is to be found.
AUTO_DIRECTION = 0.0


def silent(_stage: str) -> None:
    """Report nothing."""


class Options(NamedTuple):
    """Options of an identification.

    ``zero`` is where the pendulum's angle is 0 (auto, upright, hanging, or the measured angle of
    the hanging pendulum [rad]), ``window`` the length of the segments that are simulated [s] (None:
    automatic), ``angles`` the unit of the angles (auto, rad, deg), ``command_scale`` the voltage
    that a command of 1 stands for [V], ``direction`` that of the pendulum's angle (1, −1, 0: auto),
    ``ceiling`` the highest voltage of the drive [V] (None: found, if the data show it). ``report``
    is called with each stage of the fit.
    """

    zero: str | float = "auto"
    window: float | None = None
    angles: str = "auto"
    command_scale: float = 1.0
    direction: float = AUTO_DIRECTION
    ceiling: float | None = None
    report: Callable[[str], None] = silent
