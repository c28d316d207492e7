"""``furuta identify``."""

from math import isfinite, nan, radians
from pathlib import Path
from typing import Any

import click

from furuta.identification.options import ANGLE_UNITS, AUTO_DIRECTION, ZEROS
from furuta.identification.verdict import NO
from furuta.results.text import values_text
from furuta_bringup.option_types import PARAMETER_FILE, PATH, FiniteRange
from furuta_bringup.options import figure_option, json_option, names_options, option
from furuta_bringup.printing import print_text, show, with_status
from furuta_recordings.readers import Mapping, read
from furuta_recordings.readers.mapping import NO_COMMAND

DIRECTIONS = {"auto": AUTO_DIRECTION, "1": 1.0, "-1": -1.0}
# A pendulum that swings freely gives no model of the arm and its drive.
FREE = (f"--command {NO_COMMAND}",)


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


@click.command()
@click.argument("paths", nargs=-1, required=True, type=PATH, metavar="PATH...")
@names_options
@option(
    "--zero",
    callback=_zero,
    default="auto",
    not_with=FREE,
    help="Pendulum position at which the angle is 0 (auto, upright, hanging), or the measured "
    "angle of the hanging pendulum in degrees.",
)
@option(
    "--direction",
    type=click.Choice(list(DIRECTIONS)),
    default="auto",
    not_with=FREE,
    help="Direction of the pendulum's angle: 1 if an upright pendulum falls in its negative "
    "direction when the arm accelerates in its positive one.",
)
@option("--angles", type=click.Choice(ANGLE_UNITS), default="auto", help="Unit of the angles.")
@option(
    "--command-scale",
    type=FiniteRange(0.0, min_open=True),
    default=1.0,
    metavar="V",
    not_with=FREE,
    help="Voltage of a command of 1 [V].",
)
@option(
    "--ceiling",
    type=FiniteRange(0.0, 1e3, min_open=True),
    metavar="V",
    not_with=FREE,
    help="Highest voltage of the drive [V]; default: detected, if the data show it.",
)
@option(
    "--window",
    type=FiniteRange(0.05, 1e4),
    not_with=FREE,
    help="Length of the segments that are simulated [s]; default: the whole recording, or 0.5 for "
    "a balanced pendulum.",
)
@option(
    "--validate",
    "validation_paths",
    multiple=True,
    type=PATH,
    metavar="PATH",
    not_with=FREE,
    help="Recording to test the model on, which is not used for the fit; repeatable.",
)
@option(
    "--laws",
    is_flag=True,
    not_with=FREE,
    help="Compare friction laws of the arm by how well they predict held-out recordings, or "
    "held-out halves of a single recording.",
)
@figure_option("Draw the arm's friction over speed, and the recordings, measured and fitted.")
@option(
    "--write",
    type=PARAMETER_FILE,
    not_with=FREE,
    help="Write a rig file, for --rig of other commands.",
)
@option(
    "--rig",
    "base",
    default="",
    metavar="NAME|FILE",
    needs=("--write",),
    help="Rig from which --write takes sensors, line and limits; default: according to the "
    "recording.",
)
@json_option
def command(
    paths: tuple[Path, ...],
    names: Mapping,
    zero: str | float,
    direction: str,
    angles: str,
    command_scale: float,
    ceiling: float | None,
    window: float | None,
    validation_paths: tuple[Path, ...],
    laws: bool,
    figure: Path | None,
    write: Path | None,
    base: str,
    as_json: bool,
) -> None:
    """Fit the model to recordings: bags, CSV tables, or files of `simulate --out`.

    Several recordings of one rig are fitted together. Parameters that the data do not determine are
    left out, with the reason. A model that is not usable is not written. Use `--command none` if
    the pendulum swings freely while the arm rests.
    """
    from furuta import identify
    from furuta.results.rig_models import RigModel
    from furuta_hw.rigs.known_rigs import find_rig

    given = find_rig(base) if base else None
    with with_status("reading", as_json, lines=True) as report:
        result = identify(
            [read(path, names) for path in paths],
            zero=zero,
            direction=DIRECTIONS[direction],
            angles=angles,
            command_scale=command_scale,
            ceiling=ceiling,
            window=window,
            validate=[read(path, names) for path in validation_paths],
            laws=laws,
            report=report,
        )
    written: dict[str, Any] = {}
    try:
        if write and isinstance(result, RigModel) and result.verdict.usable != NO:
            found = result.write(write, given, paths[0])
            written = {"rig_file": str(write), "findings": [*result.to_dict()["findings"], *found]}
    finally:  # also if that fails
        show(result, as_json, figure, **written)
    if written and not as_json:
        print_text(values_text({"rig_file": str(write), "sensors_of_rig": found}))
    result.verdict.require()
