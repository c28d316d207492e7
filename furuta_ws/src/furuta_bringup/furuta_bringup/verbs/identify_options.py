"""Options of ``furuta identify``: each declares of which bodies a recording has it."""

from collections.abc import Callable
from math import isfinite, nan, pi, radians
from typing import Any

import click

from furuta.identification.options import ANGLE_UNITS, AUTO_DIRECTION, ZEROS
from furuta_bringup.option_types import PARAMETER_FILE, PATH, FiniteRange
from furuta_bringup.options import Function, option
from furuta_recordings.readers.mapping import NO_COMMAND

BODIES = ("pendulum", "axis", "servo", "joint")
DIRECTIONS = {"auto": AUTO_DIRECTION, "1": 1.0, "-1": -1.0}
ABOVE = FiniteRange(0.0, 1e12, min_open=True)


def _of(*bodies: str) -> tuple[str, ...]:
    return tuple(f"--body {body}" for body in bodies)


# The bodies that are no pendulum, by what is recorded of them. A pendulum that swings freely gives
# no model of the arm and its drive.
JOINTS = _of("axis", "servo", "joint")
DRIVEN, AXIS, SERVO, IN_ARM = _of("axis", "joint"), _of("axis"), _of("servo"), _of("joint")
NO_MODEL = (*JOINTS, f"--command {NO_COMMAND}")


class Length(click.ParamType):
    """A length with its unit, such as 10mm, in m."""

    name = "length"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """The length [m]."""
        from furuta_recordings.readers.columns import LENGTH_UNITS

        text = str(value).strip().lower()
        unit = next((u for u in sorted(LENGTH_UNITS, key=len)[::-1] if text.endswith(u)), "")
        try:
            size = float(text.removesuffix(unit)) * LENGTH_UNITS[unit]
        except (ValueError, KeyError):
            size = -1.0
        if not 0.0 <= size < 10.0:
            self.fail(f"'{value}' is not a length with its unit, such as 10mm or 0.01m", param, ctx)
        return size


class Counts(click.ParamType):
    """Counts of an encoder per turn, or per length such as 1000/mm, as counts per 2π rad or m."""

    name = "counts"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """The counts per 2π."""
        number, per, unit = str(value).partition("/")
        length = Length().convert(f"1{unit}", param, ctx) if per else 2.0 * pi
        try:
            counts = round(2.0 * pi * float(number) / length)
        except (ValueError, OverflowError, ZeroDivisionError):
            counts = -1
        if not 0 <= counts < 2**31:
            self.fail(f"'{value}' is no number of counts such as 4096 or 1000/mm", param, ctx)
        return counts


def _zero(context: click.Context, param: click.Parameter, value: str) -> str | float:
    """A position by name, or an angle in degrees, which becomes radians."""
    try:
        angle = radians(float(value))
    except ValueError:
        angle = nan
    if value not in ZEROS and not isfinite(angle):
        known = ", ".join(ZEROS)
        raise click.BadParameter(f"'{value}' is not one of {known} or an angle in degrees")
    return value if value in ZEROS else angle


def _together(*options: Callable[[Function], Function]) -> Callable[[Function], Function]:
    """Several options, which help shows in this order."""

    def add(function: Function) -> Function:
        for each in reversed(options):
            function = each(function)
        return function

    return add


body_option = option(
    "--body",
    type=click.Choice(BODIES),
    default="pendulum",
    help="What was recorded: a pendulum; an axis that its torque alone moves; a servo with a "
    "position loop of its own; or a joint of an arm that moves.",
)

# Names in the recordings.
name_options = _together(
    option("--arm", metavar="NAME", not_with=JOINTS, help="Joint of the arm."),
    option("--pendulum", metavar="NAME", not_with=JOINTS, help="Joint of the pendulum."),
    option("--states", metavar="TOPIC", not_with=JOINTS, help="Topic of the joint states."),
    option(
        "--joint",
        "joints",
        metavar="NAME",
        multiple=True,
        needs=JOINTS,
        once_with=(*IN_ARM, "--position", "--command", "--goal"),
        help="Joint to use if there are several; repeatable, to identify each of them.",
    ),
    option("--position", metavar="COLUMN", needs=JOINTS, help="Column of the position."),
    option(
        "--command",
        metavar="NAME",
        not_with=SERVO,
        help="Column or topic of the voltage, torque or current; effort: that of the joint states; "
        "none: a pendulum that swings freely.",
    ),
    option(
        "--goal",
        metavar="COLUMN",
        needs=SERVO,
        help="Column of the servo's goal, in the unit of the position; default: that of its "
        "command.",
    ),
    option("--time", metavar="COLUMN", help="Column of the time in a table."),
    option(
        "--columns",
        metavar="NAME,...",
        help="Names of the columns of a table without a header, such as time,position,torque.",
    ),
    option("--rate", type=ABOVE, metavar="HZ", help="Rows per second of a table without times."),
)

# What is known of the body.
known_options = _together(
    option(
        "--torque-constant",
        type=FiniteRange(),
        needs=DRIVEN,
        help="Torque or force per unit of the column of --command; default: 1.",
    ),
    option(
        "--lead",
        type=Length(),
        metavar="LENGTH",
        needs=DRIVEN,
        help="Way per turn of the motor, such as 10mm, if the position is a length and the "
        "drive a torque.",
    ),
    option(
        "--moving",
        metavar="NAME[=COLUMN]",
        multiple=True,
        needs=IN_ARM,
        help="Another joint of the arm that moves in the recording; repeatable.",
    ),
    option(
        "--urdf",
        type=PATH,
        metavar="FILE",
        needs=IN_ARM,
        help="Geometry of the arm, with joints that are named as --joint and --moving.",
    ),
    option(
        "--zero",
        callback=_zero,
        default="auto",
        not_with=NO_MODEL,
        help="Pendulum position at which the angle is 0 (auto, upright, hanging), or the measured "
        "angle of the hanging pendulum in degrees.",
    ),
    option(
        "--direction",
        type=click.Choice(list(DIRECTIONS)),
        default="auto",
        not_with=NO_MODEL,
        help="Direction of the pendulum's angle: 1 if an upright pendulum falls in its negative "
        "direction when the arm accelerates in its positive one.",
    ),
    option(
        "--angles",
        type=click.Choice(ANGLE_UNITS),
        default="auto",
        not_with=JOINTS,
        help="Unit of the angles.",
    ),
    option(
        "--command-scale",
        type=FiniteRange(0.0, min_open=True),
        default=1.0,
        metavar="V",
        not_with=NO_MODEL,
        help="Voltage of a command of 1 [V].",
    ),
    option(
        "--ceiling",
        type=FiniteRange(0.0, 1e3, min_open=True),
        metavar="V",
        not_with=NO_MODEL,
        help="Highest voltage of the drive [V]; default: detected, if the data show it.",
    ),
    option(
        "--window",
        type=FiniteRange(0.05, 1e4),
        not_with=NO_MODEL,
        help="Length of the segments that are simulated [s]; default: the whole recording, or 0.5 "
        "for a balanced pendulum.",
    ),
    option(
        "--validate",
        multiple=True,
        type=PATH,
        metavar="PATH",
        not_with=NO_MODEL,
        help="Recording to test the model on, which is not used for the fit; repeatable.",
    ),
    option(
        "--laws",
        is_flag=True,
        not_with=NO_MODEL,
        help="Compare friction laws of the arm by how well they predict held-out recordings, or "
        "held-out halves of a single recording.",
    ),
)

# What is written.
file_options = _together(
    option(
        "--write",
        type=PARAMETER_FILE,
        not_with=(*SERVO, *IN_ARM, f"--command {NO_COMMAND}"),
        help="Write a rig file, for --rig of other commands, or a joint file of axes, for "
        "friction observers and `furuta axis`.",
    ),
    option(
        "--rig",
        "base",
        default="",
        metavar="NAME|FILE",
        needs=("--write",),
        not_with=JOINTS,
        help="Rig from which --write takes sensors, line and limits; default: according to the "
        "recording.",
    ),
    option(
        "--force",
        is_flag=True,
        needs=AXIS,
        help="Write axes that are not usable.",
    ),
)
