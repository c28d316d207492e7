"""``furuta identify``."""

from math import isfinite, nan, radians
from pathlib import Path

import click

from furuta.identification.options import ANGLE_UNITS, AUTO_DIRECTION, ZEROS, Options
from furuta_bringup.option_types import FIGURE, PATH, FiniteRange
from furuta_bringup.options import json_option, names_options, option
from furuta_bringup.printing import escaped, print_json, show
from furuta_model.parameters import ParameterError
from furuta_recordings.readers import Mapping
from furuta_recordings.readers.mapping import NO_COMMAND

DIRECTIONS = {"auto": AUTO_DIRECTION, "1": 1.0, "-1": -1.0}


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
    help="Pendulum position at which the angle is 0 (auto, upright, hanging), or the measured "
    "angle of the hanging pendulum in degrees.",
)
@option(
    "--direction",
    type=click.Choice(list(DIRECTIONS)),
    default="auto",
    help="Direction of the pendulum's angle: 1 if an upright pendulum falls in its negative "
    "direction when the arm accelerates in its positive one.",
)
@option("--angles", type=click.Choice(ANGLE_UNITS), default="auto", help="Unit of the angles.")
@option(
    "--command-scale",
    type=FiniteRange(0.0, min_open=True),
    default=1.0,
    metavar="V",
    help="Voltage of a command of 1 [V].",
)
@option(
    "--ceiling",
    type=FiniteRange(0.0, 1e3, min_open=True),
    metavar="V",
    help="Highest voltage of the drive [V]; default: detected, if the data show it.",
)
@option(
    "--window",
    type=FiniteRange(0.05, 1e4),
    help="Length of the segments that are simulated [s]; default: the whole recording, or 0.5 for "
    "a balanced pendulum.",
)
@option(
    "--validate",
    "validation_paths",
    multiple=True,
    type=PATH,
    metavar="PATH",
    help="Recording to test the model on, which is not used for the fit; repeatable.",
)
@option(
    "--laws",
    is_flag=True,
    help="Compare friction laws of the arm by how well they predict held-out recordings, or "
    "held-out halves of a single recording.",
)
@option("--out", type=FIGURE, help="Draw the residuals.")
@option(
    "--figure",
    type=FIGURE,
    help="Draw the arm's friction over speed, and its angle, measured and fitted.",
)
@option(
    "--write", type=PATH, metavar="FILE.yaml", help="Write a rig file, for --rig of other commands."
)
@option(
    "--rig",
    "base",
    default="",
    metavar="NAME|FILE",
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
    out: Path | None,
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
    from rich.console import Console
    from rich.markup import escape

    from furuta.identification.identify import free_swing_of_files, identify_files
    from furuta.identification.result.report import full_report, report_lines, verdict_of
    from furuta.identification.verdict import NO
    from furuta_hw.rigs.known_rigs import find_rig

    options = Options(zero, window, angles, command_scale, DIRECTIONS[direction], ceiling)
    if base and write is None:
        raise ParameterError(
            "--rig gives the sensors, line and limits of the rig that is written: "
            "add --write FILE.yaml, or leave --rig out"
        )
    if names.command == NO_COMMAND:
        if out or figure or write or validation_paths or laws:
            raise ParameterError(
                "free swings give no model: no --out, --figure, --write, --validate, --laws"
            )
        swing = free_swing_of_files(paths, names, options).as_json()
        show(swing, as_json)
        verdict_of(swing).require()
        return
    given = find_rig(base) if base else None
    console = Console(stderr=True)
    with console.status("reading") as status:
        # Without a terminal there is no line to update: a line for each stage.
        stage = status.update if console.is_terminal else console.print
        options = options._replace(report=lambda text: stage(escape(escaped(text))))
        model, fitted, held_out = identify_files(paths, validation_paths, names, options)
        if laws:
            from furuta.identification.fitting.friction_laws import (
                compare_laws,
                simplest_adequate_law,
            )

            compared = compare_laws(model, options.report)
    result = full_report(model, fitted, held_out)
    if laws:
        result["friction_laws"] = [law._asdict() for law in compared]
        result["simplest_adequate_law"] = simplest_adequate_law(compared).law
    if out is not None:
        from furuta.figures.residual import draw_residuals

        draw_residuals(fitted, held_out, out)
        result["figure"] = str(out)
    if figure is not None:
        from furuta.figures.friction import draw_friction
        from furuta.identification.result.rig_friction import rig_followed, rig_friction

        draw_friction(rig_friction(model), rig_followed(fitted), figure)
        result["friction_figure"] = str(figure)
    verdict = verdict_of(result)
    if write is not None and verdict.usable != NO:
        from furuta.identification.result.identified_rig import write_rig

        result["findings"] += write_rig(model, write, given, paths[0], verdict)
        result["rig_file"] = str(write)
    if as_json:
        print_json(result)
    else:
        print(*map(escaped, report_lines(result)), sep="\n")
    verdict.require()
