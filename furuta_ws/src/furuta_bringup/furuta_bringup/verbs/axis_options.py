"""Options of ``furuta axis``: the axis by numbers, its controller, and recordings of it."""

from collections.abc import Callable
from functools import partial, wraps
from math import pi
from pathlib import Path
from typing import Any, cast

import click

from furuta_bringup.option_types import PATH, FiniteRange
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
        """The length [m]; a number alone is one already."""
        from furuta_recordings.readers.columns import LENGTH_UNITS

        text = str(value).strip().lower()
        unit = next((u for u in sorted(LENGTH_UNITS, key=len)[::-1] if text.endswith(u)), "")
        try:
            size = float(text.removesuffix(unit)) * LENGTH_UNITS.get(unit, 1.0)
        except ValueError:
            size = -1.0
        if not 0.0 <= size < 10.0:
            self.fail(f"'{value}' is not a length such as 10mm or 0.01m", param, ctx)
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


GAIN = FiniteRange(0.0, 1e12)
ABOVE = FiniteRange(0.0, 1e12, min_open=True)
# Options that only a recording has, by their names in Python.
OF_READER = ("position", "command", "torque_constant", "time", "lead")


def _together(*options: Callable[[Function], Function]) -> Callable[[Function], Function]:
    """Several options, which help shows in this order."""

    def add(function: Function) -> Function:
        for each in reversed(options):
            function = each(function)
        return function

    return add


number_options = _together(
    option("--inertia", type=ABOVE, metavar="J", help="Inertia [kg m²], or mass [kg]."),
    option(
        "--friction",
        metavar="NAME=VALUE,...",
        help=f"Friction parameters: {', '.join(Friction._fields)} [N m, rad/s].",
    ),
)

controller_options = _together(
    option(
        "--law",
        type=click.Choice(ANALYSED_LAWS),
        help="Friction law; default: stribeck, or stiction if the recording shows stiction.",
    ),
    option(
        "--pid",
        type=GAIN,
        nargs=3,
        metavar="KP KI KD",
        help="PID [N m/rad, N m/(rad s), N m s/rad].",
    ),
    option(
        "--cascade",
        type=GAIN,
        nargs=3,
        metavar="K KV KI",
        help="P for the position [1/s], PI for the speed [N m s/rad, N m/rad].",
    ),
    option(
        "--reference-speed",
        "speed",
        type=FiniteRange(-1e6, 1e6),
        metavar="V",
        help="Speed of the reference [rad/s]; default: 0.",
    ),
    option(
        "--counts",
        type=Counts(),
        help="Encoder counts per turn, or per length such as 1000/mm; 0 for a perfect encoder; "
        "default: those of the recording, or 4096.",
    ),
    option(
        "--sample-time",
        type=FiniteRange(1e-6, 0.1),
        help="Time between samples [s]; default: that of the recording, or 0.001.",
    ),
    option(
        "--prove",
        is_flag=True,
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
        help="Identify inertia and friction from a table or bag with time, position and "
        "torque; repeatable. Give no controller to do only this.",
    ),
    option("--force", is_flag=True, help="Use an identification that is not usable."),
    option("--position", metavar="COLUMN", help="Column of the position."),
    option(
        "--command",
        metavar="COLUMN",
        help="Column or topic of the drive's torque, current or voltage; default in a bag: "
        "the joint's effort.",
    ),
    option(
        "--joint",
        "joints",
        metavar="NAME",
        multiple=True,
        help="Joint to use if a bag has several; repeatable, to identify each of them.",
    ),
    option(
        "--moving",
        metavar="NAME[=COLUMN]",
        multiple=True,
        help="Another joint of the arm that moves in the recording; repeatable. Identifies "
        "the friction of --joint alone.",
    ),
    option(
        "--urdf",
        type=PATH,
        metavar="FILE",
        help="Geometry of the arm, with joints that are named as --joint and --moving.",
    ),
    option(
        "--goal",
        metavar="COLUMN",
        help="Column of the goal of a servo with a position loop of its own, in the unit of "
        "the position. Identifies the servo in units of that loop's stiffness.",
    ),
    option(
        "--torque-constant",
        type=FiniteRange(),
        help="Torque or force per unit of the column of --command; default: 1.",
    ),
    option("--time", metavar="COLUMN", help="Column of the time."),
    option(
        "--lead",
        type=Length(),
        metavar="LENGTH",
        help="Way per turn of the motor, such as 10mm, if the position is a length and the "
        "drive a torque.",
    ),
    option(
        "--save",
        type=click.Path(dir_okay=False, path_type=Path),
        metavar="FILE.yaml",
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
