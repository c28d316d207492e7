"""``furuta identify``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from furuta.results.text import values_text
from furuta_bringup.option_types import PATH
from furuta_bringup.options import figure_option, json_option
from furuta_bringup.printing import print_text, show, with_status
from furuta_bringup.verbs.identify_options import (
    DIRECTIONS,
    IN_ARM,
    SERVO,
    body_option,
    file_options,
    known_options,
    name_options,
)
from furuta_recordings.readers import Mapping, read, read_axis
from furuta_recordings.readers.mapping import NO_COMMAND

if TYPE_CHECKING:
    from furuta import Recording
    from furuta.identification.estimates import Estimates
    from furuta.results.identified import Fits

Report = Callable[[str], None]
# Options of readers, by their names in Python: those of everything, and those of what drives it.
OF_TABLE, OF_DRIVE = ("time", "columns", "rate"), ("command", "torque_constant", "lead")


@click.command()
@click.argument("paths", nargs=-1, required=True, type=PATH, metavar="PATH...")
@body_option
@name_options
@known_options
@figure_option(
    "Draw friction over speed, and the recordings, measured and fitted.", not_with=SERVO + IN_ARM
)
@file_options
@json_option
def command(
    paths: tuple[Path, ...],
    body: str,
    figure: Path | None,
    write: Path | None,
    base: str,
    force: bool,
    as_json: bool,
    **given: Any,
) -> None:
    """Fit a body to recordings: bags, tables, or files of `simulate --out`.

    Several recordings of one body are fitted together. What the data do not determine is left out,
    with the reason. What is not usable is not written. Use `--command none` if the pendulum swings
    freely while the arm rests.

    Example: furuta identify --body axis moves.csv --write joint.yaml
    """
    with with_status("reading", as_json, lines=True) as report:
        found = (_pendulum if body == "pendulum" else _joint)(paths, body, report, given)
    written: dict[str, Any] = {}
    try:
        if write and (force or found.is_usable):
            written = _written(found, write, base, paths[0])
    finally:  # also if that fails
        show(found, as_json, figure, **written)
    if written and not as_json:
        print_text(values_text(written))
    found.require(force)


def _pendulum(
    paths: Sequence[Path], body: str, report: Report, given: dict[str, Any]
) -> Estimates | Fits:
    """What recordings tell of a pendulum."""
    from furuta import PendulumBody, identify

    names = Mapping(**{name: given[name] for name in Mapping._fields})
    own = ("zero", "angles", "command_scale", "ceiling", "window", "laws")
    pendulum = PendulumBody(
        direction=DIRECTIONS[given["direction"]],
        validate=[read(path, names) for path in given["validate"]],
        **{name: given[name] for name in own},
    )
    return identify([read(path, names) for path in paths], pendulum, report=report)


def _joint(
    paths: Sequence[Path], body: str, report: Report, given: dict[str, Any]
) -> Estimates | Fits:
    """What recordings tell of axes, servos or a joint."""
    from furuta import AxisBody, JointBody, ServoBody, identify
    from furuta_recordings.readers.assembly import one_after_the_other

    still: dict[str, Any] = {"command": NO_COMMAND}

    def known(names: Sequence[str]) -> dict[str, Any]:
        return {name: given[name] for name in names if given[name] is not None}

    def own(joint: str | None) -> list[Recording]:
        drive = still if given["goal"] is not None else known(OF_DRIVE)
        names: dict[str, Any] = {"position": given["position"], "joint": joint}
        return [read_axis(path, **drive, **names, **known(OF_TABLE)) for path in paths]

    def position(column: str | None, joint: str | None) -> Recording:
        names: dict[str, Any] = {"position": column, "joint": joint}
        return one_after_the_other(
            [read_axis(path, **still, **names, **known(OF_TABLE)) for path in paths]
        )

    joints = given["joints"]
    if len(joints) > 1:
        each = AxisBody() if body == "axis" else ServoBody()
        return identify({joint: own(joint) for joint in joints}, each, report=report)
    joint = next(iter(joints), None)
    if body == "axis":
        return identify(own(joint), AxisBody(), report=report)
    if body == "servo":
        goal = None if given["goal"] is None else position(given["goal"], joint)
        return identify(own(joint), ServoBody(goal), report=report)
    split = (each.partition("=") for each in given["moving"])
    moving = [position(column or None, name) for name, _, column in split]
    return identify(own(joint), JointBody(moving, given["urdf"]), report=report)


def _written(found: Any, file: Path, base: str, source: Path) -> dict[str, Any]:
    """Write a rig file or a joint file; what is to be said of it."""
    from furuta.results.rig_models import RigModel
    from furuta_hw.rigs.known_rigs import find_rig

    if not isinstance(found, RigModel):
        found.write(file)
        return {"joint_file": str(file)}
    about = found.write(file, find_rig(base) if base else None, source)
    return {"rig_file": str(file), "sensors_of_rig": about}
