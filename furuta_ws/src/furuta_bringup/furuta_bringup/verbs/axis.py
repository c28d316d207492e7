"""``furuta axis``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from furuta_bringup.option_types import PARAMETER_FILE, PATH, FiniteRange
from furuta_bringup.options import Command, figure_option, json_option, option
from furuta_bringup.printing import bar, print_text, show
from furuta_bringup.verbs.identify_options import ABOVE, Counts
from furuta_model.friction.names import ANALYSED_LAWS
from furuta_model.friction.parameters import Friction

GAIN = FiniteRange(0.0, 1e12)
# Who has what an option needs.
BY_NUMBERS, SAVED = ("--inertia",), ("FILE",)


@click.command(cls=Command, one_of=[("FILE", "--inertia"), ("FILE", "--pid", "--cascade")])
@click.argument("file", required=False, type=PATH, metavar="[FILE]")
@option("--joint", metavar="NAME", needs=SAVED, help="Joint of a file that has several.")
@option(
    "--inertia",
    type=ABOVE,
    metavar="J",
    needs=("--friction",),
    not_with=SAVED,
    help="Inertia [kg m²], or mass [kg].",
)
@option(
    "--friction",
    metavar="NAME=VALUE,...",
    needs=BY_NUMBERS,
    help=f"Friction parameters: {', '.join(Friction._fields)} [N m, rad/s].",
)
@option(
    "--law",
    type=click.Choice(ANALYSED_LAWS),
    help="Friction law; default: stribeck, or stiction if the recording shows stiction.",
)
@option(
    "--pid",
    type=GAIN,
    nargs=3,
    metavar="KP KI KD",
    not_with=("--cascade",),
    help="PID [N m/rad, N m/(rad s), N m s/rad], per unit of the recorded position, such as "
    "N m/mm; default: the controller of the file.",
)
@option(
    "--cascade",
    type=GAIN,
    nargs=3,
    metavar="K KV KI",
    help="P for the position [1/s], PI for the speed [N m s/rad, N m/rad], per unit of the "
    "recorded position.",
)
@option(
    "--reference-speed",
    "speed",
    type=FiniteRange(-1e6, 1e6),
    default=0.0,
    metavar="V",
    help="Speed of the reference [rad/s].",
)
@option(
    "--counts",
    type=Counts(),
    help="Encoder counts per turn, or per length such as 1000/mm; 0 for a perfect encoder; "
    "default: those of the recording, or 4096.",
)
@option(
    "--sample-time",
    type=FiniteRange(1e-6, 0.1),
    help="Time between samples [s]; default: that of the recording, or 0.001.",
)
@option(
    "--delay",
    type=FiniteRange(0.0, 1.0),
    help="Time after which a torque acts [s]; default: that of the recording, or 0.",
)
@option(
    "--tolerance",
    type=ABOVE,
    help="Error that is allowed at rest, in the unit of the position; default: the smallest that "
    "can be had.",
)
@option(
    "--prove",
    is_flag=True,
    help="Prove the limit cycle in interval arithmetic, for the law stiction (needs python-flint).",
)
@figure_option("Draw the motion and the error.")
@option(
    "--write",
    type=PARAMETER_FILE,
    needs=SAVED,
    help="Write the joint file with this controller and the compensation that suits it.",
)
@option("--force", is_flag=True, needs=SAVED, help="Use an identification that is not usable.")
@json_option
def command(
    file: Path | None,
    joint: str | None,
    inertia: float | None,
    friction: str | None,
    law: str | None,
    pid: tuple[float, float, float] | None,
    cascade: tuple[float, float, float] | None,
    figure: Path | None,
    write: Path | None,
    force: bool,
    as_json: bool,
    **about: Any,
) -> None:
    """Find the final motion of a servo axis with friction, and what ends its hunting.

    Describe the axis by numbers, or give a joint FILE of `identify --body axis --write`. The final
    motion is computed exactly: a limit cycle (hunting, stick-slip), rest, steady or unbounded
    motion. Then changes of the integral and compensations are tried from all starts, with other
    friction and a later torque. For a joint file, all is repeated for other axes that may have
    produced its recordings, and positions and gains are in their unit. Otherwise units are N m,
    rad, kg m² and s, or N, m, kg and s.

    Example: furuta axis --inertia 0.01 --friction alpha0=0.1,alpha1=0.05 --law stiction
    --pid 2 6 0.12
    """
    from furuta import Axis, Cascade, Pid, read_joint_file, study_axis
    from furuta.axis.friction_text import friction_from_text

    given = Pid(*pid) if pid else Cascade(*cascade) if cascade else None
    progress = bar("studying the axis", as_json)
    if file is None:
        law = law or "stribeck"
        axis = Axis(inertia or 0.0, friction_from_text(friction or "", law), law)
        study = study_axis(axis, given or Pid(0.0), progress=progress, **about)
    else:
        saved = read_joint_file(file, joint)
        found = saved.axis()
        about["tolerance"] = about["tolerance"] and about["tolerance"] * found.recorded_unit[1]
        gains = found.per_radian(given) if given else saved.known()
        study = study_axis(found, gains, law=law, force=force, progress=progress, **about)
    show(study, as_json, figure)
    if write is not None:
        study.write(write)
        if not as_json:
            print_text(f"joint_file {write}")
