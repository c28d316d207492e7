"""``furuta axis``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
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
    from furuta.identification.bodies.servo import ServoFit
    from furuta.limit_cycles.joint import JointCycle

GAIN = FiniteRange(0.0, 1e12)
ABOVE = FiniteRange(0.0, 1e12, min_open=True)
# What a line says of one of several joints.
OF_FIT = ("inertia", "alpha0", "alpha1", "viscous", "gravity_sin", "gravity_cos")
SHOWN = (*OF_FIT, "usable", "reasons", "findings")
# Draws for which gains must end the hunting.
DRAWS_OF_GAINS = 20
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
    "--goal",
    metavar="COLUMN",
    help="Column of the goal of a servo with a position loop of its own, in the unit of the "
    "position. Identifies the servo in units of that loop's stiffness, without a torque.",
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
    "--figure",
    type=FIGURE,
    help="Draw what was identified: friction over speed, and the position, measured and fitted.",
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
    goal: str | None,
    torque_constant: float,
    clock: str | None,
    lead: float,
    prove: bool,
    out: Path | None,
    figure: Path | None,
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

    controllers = [gains for gains in (pid, cascade) if gains is not None]
    if len(controllers) > 1:
        raise click.UsageError("give either --pid or --cascade")
    columns = (position, driven, torque_constant, clock, lead)
    in_arm, analysed = bool(moving) or urdf is not None, bool(controllers or prove or out or figure)
    described = (inertia is not None, friction is not None)
    _refuse_combinations(described, records, joints, analysed, {"--save": save, "--figure": figure})
    if in_arm or goal is not None:
        _refuse_beside_arm_or_servo(records, analysed or save is not None, in_arm, joints, goal)
        if goal is None:
            _identify_in_arm(records[0], columns, joints[0], moving, urdf, force, as_json)
        else:
            _identify_servo(records[0], position, goal, clock, as_json)
        return
    if not controllers:
        _save(save, _identify(records, columns, joints, force, figure, as_json))
        return
    result: dict[str, Any] = {}
    found, fit, axes = 4096, None, []
    controller: Controller = Cascade(*cascade) if cascade else Pid(*(pid or ()))
    if records:
        from furuta.axis.draws import consequences, drawn_axes, identified_axis, report

        fit = _fit(records, columns, next(iter(joints), None))
        result["identified"] = _report(fit, figure, as_json)
        _require_usable(fit, force)
        axis, found = identified_axis(fit, law), round(2.0 * pi / fit.resolution)
        axes = drawn_axes(fit)
    else:
        law = law or "stribeck"
        axis = Axis(inertia or 0.0, parse_friction(friction or "", law), law)
    counts = found if counts is None else counts
    motions = servo_motions(axis, controller, reference_speed)
    cycle = next(iter(motions.values()))
    result |= {**axis_report(motions), "compensations": [], "recommended": None}
    if fit is not None:
        result |= report(fit, consequences(axes, controller, reference_speed))
    if cycle.kind != "unbounded":
        may_hunt = result.get("hunts_in", 0.0)
        result |= _advice(axis, controller, reference_speed, counts, motions, axes, fit, may_hunt)
    if prove:
        result["proof"] = _proof(axis, controller, reference_speed)
    if out is not None:
        _draw(axis, controller, cycle, reference_speed, counts, result["recommended"], out)
        result["figure"] = str(out)
    show(result, as_json)
    if fit is not None:
        _save(save, [fit], controller, result["recommended"])


def _refuse_combinations(
    described: tuple[bool, bool],
    records: Sequence[Path],
    joints: Sequence[str],
    analysed: bool,
    files: Mapping[str, Path | None],
) -> None:
    """Raise for a controller, --prove or a picture (``analysed``), or a file, where none can be.

    An axis is ``described`` by inertia and friction, or by recordings.
    """
    if described != (not records, not records):
        raise click.UsageError("give either --inertia and --friction, or --identify FILE")
    if len(joints) > 1 and analysed:
        raise click.UsageError(
            "several joints have no common controller, --prove, --out or --figure"
        )
    given = [option for option, path in files.items() if path is not None]
    if given and not records:
        raise click.UsageError(f"{given[0]} needs what is identified: give --identify FILE")


def _refuse_beside_arm_or_servo(
    records: Sequence[Path],
    more_than_identified: bool,
    in_arm: bool,
    joints: Sequence[str],
    goal: str | None,
) -> None:
    """Raise for what --moving, --urdf and --goal do not go with."""
    if in_arm and goal is not None:
        raise click.UsageError("a servo is identified alone: give --goal or --moving")
    given = "--moving and --urdf" if in_arm else "--goal"
    if more_than_identified:
        raise click.UsageError(f"no controller, picture or joint file with {given}")
    if len(records) != 1 or (in_arm and len(joints) != 1):
        raise click.UsageError(f"{given}: give one --identify FILE{' and one --joint' * in_arm}")


def _advice(
    axis: Axis,
    controller: Controller,
    speed: float,
    counts: int,
    motions: Mapping[str, JointCycle],
    axes: Sequence[Axis],
    fit: AxisFit | None,
    may_hunt: float,
) -> dict[str, Any]:
    """Which compensation helps, and which gains end the hunting without one.

    ``axes`` are those that the recording of a ``fit`` may come from, of which a part ``may_hunt``.
    """
    from furuta.axis.compensations import compare_on_axis
    from furuta.axis.draws import COMPARED
    from furuta.axis.quiet_gains import COUNTS, FEW, HUNTING, gain_rows, quiet_gains

    cycle, *_ = motions.values()
    sampled: dict[str, Any] = {"speed": speed, "counts": counts}
    if fit is not None:
        delay = fit.values.get("delay", 0.0)
        sampled |= {"sample_time": fit.recordings[0].interval, "delay": delay}
    compared = compare_on_axis(
        axis,
        controller,
        cycle=cycle,
        others=axes[:COMPARED],
        **sampled,
        **(_of_a_robot(fit) if fit is not None else {}),
    )
    best = compared.recommended
    moves = best.peak_to_peak_rad > COUNTS * 2.0 * pi / counts if counts else True
    advice: dict[str, Any] = {
        "compensations": [residual._asdict() for residual in compared.residuals],
        "still_hunts": moves and cycle.kind in HUNTING,
        "recommended": best.compensation if best.settled else None,
        "ends_hunting": None,
    }
    quiet = None
    if may_hunt > FEW or any(motion.kind in HUNTING for motion in motions.values()):
        gains = quiet_gains(axis, controller, others=axes[:DRAWS_OF_GAINS], **sampled)
        quiet, advice["ends_hunting"] = gains.controller, gains.sentence()
    recording = fit.recordings[0] if fit is not None else None
    units = recording.units if recording else ("rad", "N m")
    recorded = recording.position_unit if recording else ("rad", 1.0)
    return advice | {"gains": gain_rows(controller, quiet, units, recorded)}


def _of_a_robot(fit: AxisFit) -> dict[str, Any]:
    """A friction observer that is a node of its own, on a robot whose gears must not rattle."""
    return {"by_topic": True, "largest_chatter": QUIET * fit.values.get("alpha0", 0.0)}


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
    show(_shown(fit, as_json), as_json)
    _require_usable(fit, force)


def _identify_servo(
    record: Path, position: str | None, goal: str, clock: str | None, as_json: bool
) -> None:
    """Show what goal and position tell of a servo."""
    from furuta.identification.bodies.servo import identify_servo
    from furuta_model.state import PHI
    from furuta_recordings.readers import read_axis
    from furuta_recordings.readers.mapping import NO_COMMAND

    moved, wanted = (
        read_axis(record, column, NO_COMMAND, time=clock) for column in (position, goal)
    )
    fit = identify_servo(
        moved._replace(
            command_time=wanted.time + (wanted.start - moved.start),
            command=wanted.measured[:, PHI],
        )
    )
    show(_shown(fit, as_json), as_json)


def _shown(fit: AxisFit | ArmJointFit | ServoFit, as_json: bool) -> dict[str, Any]:
    return {name: value for name, value in fit.report().items() if as_json or name != "covariance"}


def _report(fit: AxisFit, figure: Path | None, as_json: bool) -> dict[str, Any]:
    """What is shown of a fit, after it has been drawn: also of one that is not usable."""
    report = _shown(fit, as_json)
    if figure is not None:
        from furuta.figures.friction import draw_friction
        from furuta.identification.axis.friction_curve import axis_followed, axis_friction

        draw_friction(axis_friction(fit), axis_followed(fit), figure)
        report["figure"] = str(figure)
    return report


def _identify(
    records: Sequence[Path],
    columns: Sequence[Any],
    joints: Sequence[str],
    force: bool,
    figure: Path | None,
    as_json: bool,
) -> list[AxisFit]:
    """Fits of the joints, after they have been shown; raises if one is not usable."""
    if not records:
        raise click.UsageError("give the controller: either --pid or --cascade")
    if len(joints) > 1:
        return _identify_joints(records, columns, joints, force, as_json)
    fit = _fit(records, columns, next(iter(joints), None))
    show(_report(fit, figure, as_json), as_json)
    _require_usable(fit, force)
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
            _require_usable(fit, force)
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


def _require_usable(fit: AxisFit | ArmJointFit, force: bool) -> None:
    if not force:
        fit.verdict.require("; --force uses it all the same")


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
