"""Options of ``furuta axis``: the axis by numbers, its controller, and recordings of it."""

from collections.abc import Callable
from functools import partial, wraps
from math import pi
from typing import Any, cast

import click

from furuta_bringup.option_types import PARAMETER_FILE, PATH, FiniteRange
from furuta_bringup.options import Function, option
from furuta_model.friction.names import ANALYSED_LAWS
from furuta_model.friction.parameters import Friction
from furuta_recordings.readers import read_axis


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


# Who has what an option needs, or leaves it without effect.
CONTROLLER = ("--pid", "--cascade")
RECORDING = ("--identify",)
IN_ARM = ("--moving", "--urdf")
SERVO = ("--goal",)

GAIN = FiniteRange(0.0, 1e12)
ABOVE = FiniteRange(0.0, 1e12, min_open=True)
# Options that only a recording has, by their names in Python.
OF_READER = ("position", "command", "torque_constant", "time", "lead", "columns", "rate")
# Those that say how a table is read.
OF_TABLE = ("time", "columns", "rate")


def _together(*options: Callable[[Function], Function]) -> Callable[[Function], Function]:
    """Several options, which help shows in this order."""

    def add(function: Function) -> Function:
        for each in reversed(options):
            function = each(function)
        return function

    return add


number_options = _together(
    option(
        "--inertia",
        type=ABOVE,
        metavar="J",
        needs=("--friction",),
        not_with=RECORDING,
        help="Inertia [kg m²], or mass [kg].",
    ),
    option(
        "--friction",
        metavar="NAME=VALUE,...",
        needs=("--inertia",),
        not_with=RECORDING,
        help=f"Friction parameters: {', '.join(Friction._fields)} [N m, rad/s].",
    ),
)

controller_options = _together(
    option(
        "--law",
        type=click.Choice(ANALYSED_LAWS),
        needs=CONTROLLER,
        help="Friction law; default: stribeck, or stiction if the recording shows stiction.",
    ),
    option(
        "--pid",
        type=GAIN,
        nargs=3,
        metavar="KP KI KD",
        not_with=("--cascade", *IN_ARM, *SERVO),
        help="PID [N m/rad, N m/(rad s), N m s/rad], per unit of the recorded position, such as "
        "N m/mm.",
    ),
    option(
        "--cascade",
        type=GAIN,
        nargs=3,
        metavar="K KV KI",
        not_with=(*IN_ARM, *SERVO),
        help="P for the position [1/s], PI for the speed [N m s/rad, N m/rad], per unit of the "
        "recorded position.",
    ),
    option(
        "--reference-speed",
        "speed",
        type=FiniteRange(-1e6, 1e6),
        metavar="V",
        needs=CONTROLLER,
        help="Speed of the reference [rad/s]; default: 0.",
    ),
    option(
        "--counts",
        type=Counts(),
        needs=CONTROLLER,
        help="Encoder counts per turn, or per length such as 1000/mm; 0 for a perfect encoder; "
        "default: those of the recording, or 4096.",
    ),
    option(
        "--sample-time",
        type=FiniteRange(1e-6, 0.1),
        needs=CONTROLLER,
        help="Time between samples [s]; default: that of the recording, or 0.001.",
    ),
    option(
        "--delay",
        type=FiniteRange(0.0, 1.0),
        needs=CONTROLLER,
        help="Time after which a torque acts [s]; default: that of the recording, or 0.",
    ),
    option(
        "--tolerance",
        type=ABOVE,
        needs=CONTROLLER,
        help="Error that is allowed at rest, in the unit of the position; default: the smallest "
        "that can be had.",
    ),
    option(
        "--prove",
        is_flag=True,
        needs=CONTROLLER,
        help="Prove the limit cycle in interval arithmetic, for the law stiction (needs "
        "python-flint).",
    ),
)

_recording_options = _together(
    option(
        "--identify",
        "records",
        type=PATH,
        metavar="FILE",
        multiple=True,
        once_with=SERVO,
        help="Identify inertia and friction from a table or bag with time, position and "
        "torque; repeatable. Give no controller to do only this.",
    ),
    option(
        "--force",
        is_flag=True,
        needs=RECORDING,
        help="Use an identification that is not usable.",
    ),
    option("--position", metavar="COLUMN", needs=RECORDING, help="Column of the position."),
    option(
        "--command",
        metavar="COLUMN",
        needs=RECORDING,
        not_with=SERVO,
        help="Column or topic of the drive's torque, current or voltage; default in a bag: "
        "the joint's effort.",
    ),
    option(
        "--joint",
        "joints",
        metavar="NAME",
        multiple=True,
        needs=RECORDING,
        once_with=(*CONTROLLER, *IN_ARM, *SERVO, "--position", "--command"),
        help="Joint to use if a bag has several; repeatable, to identify each of them.",
    ),
    option(
        "--moving",
        metavar="NAME[=COLUMN]",
        multiple=True,
        needs=("--joint",),
        not_with=SERVO,
        help="Another joint of the arm that moves in the recording; repeatable. Identifies "
        "the friction of --joint alone.",
    ),
    option(
        "--urdf",
        type=PATH,
        metavar="FILE",
        needs=("--joint",),
        not_with=SERVO,
        help="Geometry of the arm, with joints that are named as --joint and --moving.",
    ),
    option(
        "--goal",
        metavar="COLUMN",
        needs=RECORDING,
        help="Column of the goal of a servo with a position loop of its own, in the unit of "
        "the position. Identifies the servo in units of that loop's stiffness.",
    ),
    option(
        "--torque-constant",
        type=FiniteRange(),
        needs=RECORDING,
        not_with=SERVO,
        help="Torque or force per unit of the column of --command; default: 1.",
    ),
    option("--time", metavar="COLUMN", needs=RECORDING, help="Column of the time."),
    option(
        "--columns",
        metavar="NAME,...",
        needs=RECORDING,
        help="Names of the columns of a table without a header, such as time,position,torque.",
    ),
    option(
        "--rate",
        type=ABOVE,
        metavar="HZ",
        needs=RECORDING,
        help="Rows per second of a table without times.",
    ),
    option(
        "--lead",
        type=Length(),
        metavar="LENGTH",
        needs=RECORDING,
        not_with=SERVO,
        help="Way per turn of the motor, such as 10mm, if the position is a length and the "
        "drive a torque.",
    ),
    option(
        "--save",
        type=PARAMETER_FILE,
        needs=RECORDING,
        not_with=(*IN_ARM, *SERVO),
        help="Write what is identified to a joint file: parameters of friction observers.",
    ),
)


def recording_options(function: Function) -> Function:
    """What describes recordings; the command gets ``read``, which reads one."""

    @wraps(function)
    def with_reader(*args: Any, **others: Any) -> Any:
        columns = {name: others.pop(name) for name in OF_READER}
        known = {name: value for name, value in columns.items() if value is not None}
        return function(*args, read=partial(read_axis, **known), **others)

    return _recording_options(cast(Function, with_reader))
