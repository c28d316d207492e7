"""``furuta axis``."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from furuta_bringup.option_types import FIGURE, FiniteRange
from furuta_bringup.options import json_option
from furuta_bringup.printing import show
from furuta_model.friction.names import ANALYSED_LAWS
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError
from furuta_ros.errors import UserError

if TYPE_CHECKING:
    from furuta.axis.axis import Axis, Controller
    from furuta.identification.axis.identify import AxisFit
    from furuta.identification.bodies.arm_joint import ArmJointFit
    from furuta.limit_cycles.joint import JointCycle

# Motions without end about a reference at rest.
HUNTING = ("limit_cycle", "irregular")
GAIN = FiniteRange(0.0, 1e12)
ABOVE = FiniteRange(0.0, 1e12, min_open=True)
# What a line says of one of several joints.
OF_FIT = ("inertia", "alpha0", "alpha1", "viscous", "gravity_sin", "gravity_cos")
SHOWN = (*OF_FIT, "usable", "reasons", "findings")
# Chatter, relative to the level of friction, of a compensation that is recommended for a robot.
QUIET = 0.25


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


@click.command()
@click.option("--inertia", type=ABOVE, metavar="J", help="Inertia [kg m²], or mass [kg].")
@click.option(
    "--friction",
    metavar="NAME=VALUE,...",
    help=f"Friction parameters: {', '.join(Friction._fields)} [N m, rad/s].",
)
@click.option(
    "--law",
    type=click.Choice(ANALYSED_LAWS),
    help="Friction law; default: stribeck, or stiction if the recording shows stiction.",
)
@click.option(
    "--pid", type=GAIN, nargs=3, metavar="KP KI KD", help="PID [N m/rad, N m/(rad s), N m s/rad]."
)
@click.option(
    "--cascade",
    type=GAIN,
    nargs=3,
    metavar="K KV KI",
    help="P for the position [1/s], PI for the speed [N m s/rad, N m/rad].",
)
@click.option(
    "--reference-speed",
    type=FiniteRange(-1e6, 1e6),
    default=0.0,
    show_default=True,
    help="Speed of the reference [rad/s].",
)
@click.option(
    "--counts",
    type=click.IntRange(0, 2**31),
    help="Encoder counts per turn (per 2π m of a linear axis), 0 for a perfect encoder; default: "
    "those of the recording, or 4096.",
)
@click.option(
    "--identify",
    "records",
    type=click.Path(path_type=Path),
    metavar="FILE",
    multiple=True,
    help="Identify inertia and friction from a table or bag with time, position and "
    "torque; repeatable. Give no controller to do only this.",
)
@click.option("--force", is_flag=True, help="Use an identification that is not usable.")
@click.option("--position", metavar="COLUMN", help="Column of the position.")
@click.option(
    "--command",
    "driven",
    metavar="COLUMN",
    help="Column or topic of the drive's "
    "torque, current or voltage; default in a bag: the joint's effort.",
)
@click.option(
    "--joint",
    "joints",
    metavar="NAME",
    multiple=True,
    help="Joint to use if a bag has several; repeatable, to identify each of them.",
)
@click.option(
    "--moving",
    metavar="NAME[=COLUMN]",
    multiple=True,
    help="Another joint of the arm that moves in the recording; repeatable. Identifies the "
    "friction of --joint alone.",
)
@click.option(
    "--urdf",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Geometry of the arm, with joints that are named as --joint and --moving.",
)
@click.option(
    "--torque-constant",
    type=FiniteRange(),
    default=1.0,
    show_default=True,
    help="Torque or force per unit of the column of --command.",
)
@click.option("--time", "clock", metavar="COLUMN", help="Column of the time.")
@click.option(
    "--lead",
    type=Length(),
    default=0.0,
    metavar="LENGTH",
    help="Way per turn of the motor, such as 10mm, if the position is a length and the drive a "
    "torque.",
)
@click.option(
    "--prove",
    is_flag=True,
    help="Prove the limit cycle in interval arithmetic, for the law stiction (needs python-flint).",
)
@click.option(
    "--out",
    type=FIGURE,
    help="Draw the limit cycle, and the error with the recommended compensation.",
)
@click.option(
    "--save",
    type=click.Path(dir_okay=False, path_type=Path),
    metavar="FILE.yaml",
    help="Write what is identified to a joint file: parameters of friction observers.",
)
@json_option
def command(
    inertia: float | None,
    friction: str | None,
    law: str | None,
    pid: tuple[float, float, float] | None,
    cascade: tuple[float, float, float] | None,
    reference_speed: float,
    counts: int | None,
    records: tuple[Path, ...],
    force: bool,
    position: str | None,
    driven: str | None,
    joints: tuple[str, ...],
    moving: tuple[str, ...],
    urdf: Path | None,
    torque_constant: float,
    clock: str | None,
    lead: float,
    prove: bool,
    out: Path | None,
    save: Path | None,
    as_json: bool,
) -> None:
    """Find the final motion of a servo axis with friction, and which compensation helps.

    Describe the axis by numbers or by a recording. The final motion is computed exactly: a limit
    cycle (hunting, stick-slip), rest, steady or unbounded motion. Then each compensation is
    simulated at 1 kHz with the encoder, and one is recommended. For a recording, both are repeated
    for other axes that may have produced it. Units are N m, rad, kg m² and s, or N, m, kg and s.

    Example: furuta axis --inertia 0.01 --friction alpha0=0.1,alpha1=0.05 --law stiction
    --pid 2 6 0.12
    """
    from furuta.axis.axis import Axis, Cascade, Pid, axis_report, parse_friction, servo_motions
    from furuta.axis.compensations import compare_on_axis

    controllers = [gains for gains in (pid, cascade) if gains is not None]
    if len(controllers) > 1:
        raise click.UsageError("give either --pid or --cascade")
    if (inertia is not None, friction is not None) != (not records, not records):
        raise click.UsageError("give either --inertia and --friction, or --identify FILE")
    in_arm = bool(moving) or urdf is not None
    _refuse_combinations(records, joints, bool(controllers or prove or out), save, in_arm)
    columns = (position, driven, torque_constant, clock, lead)
    if in_arm:
        _identify_in_arm(records[0], columns, joints[0], moving, urdf, force, as_json)
        return
    if not controllers:
        _save(save, _identify(records, columns, joints, force, as_json))
        return
    result: dict[str, Any] = {}
    others, found = [], 4096
    controller: Controller = Cascade(*cascade) if cascade else Pid(*(pid or ()))
    if records:
        from furuta.axis.draws import COMPARED, consequences, drawn_axes, identified_axis, report

        fit = _fit(records, columns, next(iter(joints), None))
        result["identified"] = _report(fit, as_json)
        _refuse_unusable(fit, force)
        axis, found = identified_axis(fit, law), round(2.0 * pi / fit.resolution)
        axes = drawn_axes(fit)
        others = axes[:COMPARED]
    else:
        law = law or "stribeck"
        axis = Axis(inertia or 0.0, parse_friction(friction or "", law), law)
    counts = found if counts is None else counts
    motions = servo_motions(axis, controller, reference_speed)
    cycle = next(iter(motions.values()))
    result |= {**axis_report(motions), "compensations": [], "recommended": None}
    if records:
        result |= report(fit, consequences(axes, controller, reference_speed))
    if cycle.kind != "unbounded":
        compared = compare_on_axis(
            axis,
            controller,
            speed=reference_speed,
            counts=counts,
            cycle=cycle,
            others=others,
            **(_loop_of_node(fit) if records else {}),
        )
        result["compensations"] = [residual._asdict() for residual in compared.residuals]
        best = compared.recommended
        hunts = best.peak_to_peak_rad > 2.0 * 2.0 * pi / counts if counts else cycle.kind in HUNTING
        result["still_hunts"] = hunts and cycle.kind in HUNTING
        result["recommended"] = best.compensation if best.settled else None
    if prove:
        result["proof"] = _proof(axis, controller, reference_speed)
    if out is not None:
        _draw(axis, controller, cycle, reference_speed, counts, result["recommended"], out)
        result["figure"] = str(out)
    show(result, as_json)
    if records:
        _save(save, [fit], controller, result["recommended"])


def _refuse_combinations(
    records: Sequence[Path], joints: Sequence[str], analysed: bool, save: Path | None, in_arm: bool
) -> None:
    """Raise for a controller, --prove or --out (``analysed``), or --save, where none can be."""
    if len(joints) > 1 and analysed:
        raise click.UsageError("several joints have no common controller, --prove or --out")
    if save is not None and not records:
        raise click.UsageError("--save writes what is identified: give --identify FILE")
    if in_arm and (analysed or save is not None):
        raise click.UsageError("--moving and --urdf identify only, and write no joint file")
    if in_arm and (len(records) != 1 or len(joints) != 1):
        raise click.UsageError("--moving and --urdf need one --identify FILE and one --joint")


def _loop_of_node(fit: AxisFit) -> dict[str, Any]:
    """The loop with a friction observer that is a node of its own, on a robot like the recorded.

    Its gears must not rattle.
    """
    return {
        "sample_time": fit.recordings[0].interval,
        "delay": fit.values.get("delay", 0.0),
        "by_topic": True,
        "largest_chatter": QUIET * fit.values.get("alpha0", 0.0),
    }


def _fit(records: Iterable[Path], columns: Sequence[Any], joint: str | None) -> AxisFit:
    from furuta.identification.axis.identify import identify_axis
    from furuta_recordings.readers import read_axis

    position, driven, constant, clock, lead = columns
    return identify_axis(
        [read_axis(each, position, driven, constant, joint, clock, lead) for each in records]
    )


def _identify_in_arm(
    record: Path,
    columns: Sequence[Any],
    joint: str,
    moving: Iterable[str],
    urdf: Path | None,
    force: bool,
    as_json: bool,
) -> None:
    """Show the friction of a joint of an arm that moves; raises if it is not usable."""
    from furuta.identification.bodies.arm_joint import identify_arm_joint
    from furuta_recordings.readers import read_axis
    from furuta_recordings.readers.mapping import NO_COMMAND

    position, driven, constant, clock, lead = columns
    others = []
    for each in moving:
        name, _, column = each.partition("=")
        others.append(read_axis(record, column or None, NO_COMMAND, joint=name, time=clock))
    own = read_axis(record, position, driven, constant, joint, clock, lead)
    fit = identify_arm_joint(own, others, urdf)
    show(_report(fit, as_json), as_json)
    _refuse_unusable(fit, force)


def _report(fit: AxisFit | ArmJointFit, as_json: bool) -> dict[str, Any]:
    return {name: value for name, value in fit.report().items() if as_json or name != "covariance"}


def _identify(
    records: Sequence[Path],
    columns: Sequence[Any],
    joints: Sequence[str],
    force: bool,
    as_json: bool,
) -> list[AxisFit]:
    """Fits of the joints, after they have been shown; raises if one is not usable."""
    if not records:
        raise click.UsageError("give the controller: either --pid or --cascade")
    if len(joints) > 1:
        return _identify_joints(records, columns, joints, force, as_json)
    fit = _fit(records, columns, next(iter(joints), None))
    show(_report(fit, as_json), as_json)
    _refuse_unusable(fit, force)
    return [fit]


def _identify_joints(
    records: Sequence[Path],
    columns: Sequence[Any],
    joints: Iterable[str],
    force: bool,
    as_json: bool,
) -> list[AxisFit]:
    fits, reports, refused = [], {}, []
    for joint in dict.fromkeys(joints):
        try:
            fit = _fit(records, columns, joint)
            reports[joint] = fit.report()
            _refuse_unusable(fit, force)
            fits.append(fit)
        except (ParameterError, UserError) as error:
            reports.setdefault(joint, {"usable": "no", "reasons": [str(error)]})
            refused.append(f"{joint}: {error}")
    rows = [
        {"joint": joint} | {name: report[name] for name in SHOWN if report.get(name)}
        for joint, report in reports.items()
    ]
    show({"joints": reports if as_json else rows}, as_json)
    if refused:
        raise UserError("; ".join(refused))
    return fits


def _save(
    path: Path | None,
    fits: Iterable[AxisFit],
    controller: Controller | None = None,
    recommended: str | None = None,
) -> None:
    if path is not None:
        from furuta.axis.joint_file import write_joint_file

        named = {fit.recordings[0].joint: fit for fit in fits}
        write_joint_file(path, named, controller, recommended)


def _refuse_unusable(fit: AxisFit | ArmJointFit, force: bool) -> None:
    from furuta.identification.result.report import UNUSABLE

    if fit.usable == UNUSABLE and not force:
        raise UserError(f"not usable: {'; '.join(fit.reasons)}; --force uses it all the same")


def _proof(axis: Axis, controller: Controller, speed: float) -> dict[str, Any]:
    if speed:
        raise ParameterError("a cycle is proved at --reference-speed 0 only")
    from furuta.axis.proof import prove_cycle  # it needs python-flint

    proof = prove_cycle(axis, controller)._asdict()
    return proof | {"certificate": proof["certificate"]._asdict()}


def _draw(
    axis: Axis,
    controller: Controller,
    cycle: JointCycle,
    speed: float,
    counts: int,
    recommended: str | None,
    out: Path,
) -> None:
    """Draw the cycle, and simulations without and with the recommended compensation."""
    from furuta.axis.axis import servo_joint
    from furuta.axis.compensations import SHORTEST
    from furuta.axis.simulation import simulate_axis
    from furuta.figures.limit_cycle import PERIODS, draw_axis
    from furuta.limit_cycles.joint import trace_joint

    motion = None
    if cycle.kind == "limit_cycle":
        motion = trace_joint(servo_joint(axis, controller, speed), cycle)
    names = dict.fromkeys(["none", recommended]) if recommended else []
    seconds = max(2.0 * PERIODS * cycle.period_s, SHORTEST) if motion else SHORTEST
    runs = {
        name: simulate_axis(
            axis,
            controller,
            seconds=seconds,
            reference=speed,
            compensation=name,
            counts=counts,
        )
        for name in names
    }
    draw_axis(motion, cycle, runs, out)
