"""``furuta export``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from furuta_bringup.option_types import FiniteRange
from furuta_bringup.options import HelpfulGroup, json_option, model_options, option
from furuta_bringup.printing import print_file, show, with_status

if TYPE_CHECKING:
    from furuta_hw.rigs.rig import Rig


out_option = click.option(
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    help="File to write instead of standard output.",
)


@click.group(cls=HelpfulGroup)
def command() -> None:
    """Export a loop for use without Python, or a rig or an identified joint for simulators."""


@command.command("c")
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    required=True,
    help="Folder for loop.h, loop.c and loop_test.c, or axis.h, axis.c and axis_test.c.",
)
@click.option("--float", "single", is_flag=True, help="Numbers of 32 bits instead of 64.")
@option(
    "--axis",
    "joints",
    type=click.Path(path_type=Path),
    metavar="FILE",
    not_with=("--rig", "--params", "--set"),
    help="Export a joint of this joint file instead of the pendulum's loop.",
)
@option(
    "--joint",
    metavar="NAME",
    needs=("--axis",),
    help="Joint of that file, if it has several.",
)
@model_options
@json_option
def c(
    out: Path,
    single: bool,
    joints: Path | None,
    joint: str | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Write estimator, friction observer and controller as C99.

    The code is translated from the functions that the nodes run. With numbers of 64 bits the
    commands are the same to the last bit. The test program compares a run. With --axis it is the
    observer of a joint, with the controller of the joint file.
    """
    from furuta import export_c, make_loop, read_joint_file

    if joints is not None:
        given = read_joint_file(joints, joint)
        about = f"Joint {given.joint} of {joints.name}. V is the unit of its effort."
        with with_status("translating into C", as_json):
            written = export_c(given, out, single=single, origin=about)
    else:
        rig, origin = _described(files)
        about = " ".join(["Control system of the Furuta pendulum.", *origin, *assignments])
        loop = make_loop(assignments, files=files)
        with with_status("translating into C", as_json):
            written = export_c(loop, out, rig=rig, single=single, origin=about)
    show(written, as_json)


@command.command("description")
@option("--rig", "name", default="paper", metavar="NAME|FILE", help="Rig, by name or file.")
@click.option("--prefix", default="", help="Begins the names of all links and joints.")
@out_option
def description(name: str, prefix: str, out: Path | None) -> None:
    """Write a rig as URDF for ROS 2 and simulators.

    Masses and inertias give the motion of the rig's model, without friction. A torque in N m is
    drive.torque_per_volt of the rig file times the voltage; where that is not known, it is 1.
    """
    from furuta_description.robot_description import robot_description
    from furuta_hw.rigs.known_rigs import find_rig
    from furuta_ros.whole_files import whole_file

    text = robot_description(find_rig(name), prefix)
    if out is None:
        print_file(text)
    else:
        with whole_file(out) as path:
            path.write_text(text, encoding="utf-8")


def _described(files: tuple[Path, ...]) -> tuple[Rig | None, list[str]]:
    """The rig of the last rig file, and what the files are."""
    from furuta_hw.rigs.rig_file import is_rig_file, rig_from_content
    from furuta_ros.yaml_files import read_yaml

    given, rig = {file: read_yaml(file, "parameter file") for file in files}, None
    for file in filter(lambda file: is_rig_file(given[file]), files):
        rig, _ = rig_from_content(given[file], file)
    return rig, list(map(_origin, given.items()))


def _joint_command(form: str, name: str, friction: str) -> None:
    """Add the command that writes a joint in a format."""

    @command.command(form, help=f"Write an identified joint as {name}.\n\n{friction}")
    @click.option(
        "--axis",
        "path",
        type=click.Path(path_type=Path),
        required=True,
        metavar="FILE",
        help="Joint file, from identify or axis --write.",
    )
    @click.option("--joint", metavar="NAME", help="Joint to use if the file has several.")
    @click.option("--prismatic", is_flag=True, help="The joint slides: N, m and kg.")
    @out_option
    def write(path: Path, joint: str | None, out: Path | None, **options: Any) -> None:
        from furuta import export_joint, read_joint_file

        text = export_joint(read_joint_file(path, joint), form, out, **options)
        if out is None:
            print_file(text)

    if form == "mjcf":
        click.option(
            "--lugre",
            is_flag=True,
            help="LuGre friction, with which the joint hunts, sticks and slips; needs MuJoCo 3.7.",
        )(write)
        click.option(
            "--step",
            type=FiniteRange(1e-6, 1e-2),
            default=1e-3,
            show_default=True,
            help="Time step [s]; the shorter, the harder is the bristle.",
        )(write)


_joint_command("urdf", "URDF", "Its friction is Coulomb and viscous.")
_joint_command("sdf", "SDF for Gazebo", "Its friction is Coulomb and viscous.")
_joint_command("mjcf", "MJCF for MuJoCo", "Its friction is Coulomb or LuGre.")


def _origin(given: tuple[Path, Any]) -> str:
    """A parameter file, with the name of a rig and the sources of its values."""
    file, content = given
    sources = "; ".join(content.get("sources", []))
    return (
        f"{file.name}: {content.get('name', '')}, from {sources}." if sources else f"{file.name}."
    )
