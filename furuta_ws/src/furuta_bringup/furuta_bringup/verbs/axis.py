"""``furuta axis``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from furuta_bringup.options import figure_option, json_option
from furuta_bringup.printing import bar, show, with_status
from furuta_bringup.verbs.axis_options import (
    IN_ARM,
    OF_TABLE,
    SERVO,
    controller_options,
    number_options,
    recording_options,
)
from furuta_recordings.readers import read_axis
from furuta_recordings.readers.mapping import NO_COMMAND

if TYPE_CHECKING:
    from furuta import Recording
    from furuta.results.identified import AxisFit, AxisFits, JointFit


@click.command()
@number_options
@controller_options
@recording_options
@figure_option("Draw the motion and the error, and what was identified.", not_with=IN_ARM + SERVO)
@json_option
def command(
    inertia: float | None,
    friction: str | None,
    pid: tuple[float, float, float] | None,
    cascade: tuple[float, float, float] | None,
    records: tuple[Path, ...],
    read: partial[Recording],
    figure: Path | None,
    as_json: bool,
    **others: Any,
) -> None:
    """Find the final motion of a servo axis with friction, and what ends its hunting.

    Describe the axis by numbers or by a recording. The final motion is computed exactly: a limit
    cycle (hunting, stick-slip), rest, steady or unbounded motion. Then changes of the integral and
    compensations are tried from all starts, with other friction and a later torque. For a
    recording, all is repeated for other axes that may have produced it, and positions are in its
    unit. Otherwise units are N m, rad, kg m² and s, or N, m, kg and s.

    Example: furuta axis --inertia 0.01 --friction alpha0=0.1,alpha1=0.05 --law stiction
    --pid 2 6 0.12
    """
    from furuta import Axis, Cascade, Pid, study_axis
    from furuta.axis.friction_text import friction_from_text
    from furuta.results.identified import AxisFit

    is_controlled = pid is not None or cascade is not None
    if not records and inertia is None:
        raise click.UsageError("give either --inertia and --friction, or --identify FILE")
    if not records and not is_controlled:
        raise click.UsageError("give the controller: either --pid or --cascade")
    law, save, force = (others[name] for name in ("law", "save", "force"))
    about = {name: others[name] for name in ("counts", "sample_time", "delay", "prove")}
    controller = Cascade(*cascade) if cascade else Pid(*(pid or (0.0,)))
    tolerance = others["tolerance"]
    if records:
        with with_status("reading", as_json, lines=True) as report:
            fit = _identified(read, records, report, **others)
        if not (is_controlled and isinstance(fit, AxisFit) and (fit.is_usable or force)):
            show(fit, as_json, figure)
            fit.require(force)
            if save is not None:
                fit.write(save)
            return
        axis: Axis | AxisFit = fit
        controller = fit.per_radian(controller)
        tolerance = tolerance and tolerance * fit.recorded_unit[1]
        about |= {"law": law, "force": force}
    else:
        law = law or "stribeck"
        axis = Axis(inertia or 0.0, friction_from_text(friction or "", law), law)
    study = study_axis(
        axis,
        controller,
        tolerance=tolerance,
        speed=others["speed"] or 0.0,
        progress=bar("studying the axis", as_json),
        **about,
    )
    show(study, as_json, figure)
    if save is not None:
        study.write(save)


def _identified(
    read: partial[Recording],
    records: Sequence[Path],
    report: Callable[[str], None],
    joints: Sequence[str],
    moving: Sequence[str],
    urdf: Path | None,
    goal: str | None,
    **_: Any,
) -> AxisFit | AxisFits | JointFit:
    """What recordings tell of an axis, of several joints, of one in an arm, or of a servo."""
    from furuta import identify_arm_joint, identify_axes, identify_axis, identify_servo
    from furuta_recordings.readers.assembly import one_after_the_other

    first, joint = records[0], next(iter(joints), None)
    about = {name: read.keywords[name] for name in OF_TABLE if name in read.keywords}

    def still(path: Path, **names: Any) -> Recording:
        return read_axis(path, command=NO_COMMAND, **about, **names)

    if goal is not None:
        position = still(first, position=read.keywords.get("position"), joint=joint)
        return identify_servo(position, still(first, position=goal))
    if moving or urdf is not None:
        own = one_after_the_other([read(each, joint=joint) for each in records])
        others = [
            one_after_the_other(
                [still(each, position=column or None, joint=name) for each in records]
            )
            for name, _, column in (each.partition("=") for each in moving)
        ]
        return identify_arm_joint(own, others, urdf)
    if len(joints) > 1:
        return identify_axes(
            {name: [read(each, joint=name) for each in records] for name in joints}, report=report
        )
    return identify_axis([read(each, joint=joint) for each in records], report=report)
