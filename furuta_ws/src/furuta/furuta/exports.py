"""Loops and joints in the languages of others: C for a microcontroller, models for simulators."""

from __future__ import annotations

from pathlib import Path

from furuta.axis.joint_file import JointFile
from furuta.export.axis_files import axis_files
from furuta.export.joint_models import FORMATS, joint_model
from furuta.export.loop_files import loop_files
from furuta.export.values import DOUBLE, FLOAT
from furuta.results.files import Files
from furuta_hw.rigs.rig import Rig
from furuta_model.parameters import ParameterError
from furuta_ros.whole_files import whole_file
from furuta_sim.simulation.closed_loop import Loop


def export_c(
    exported: Loop | JointFile,
    folder: str | Path,
    *,
    rig: Rig | None = None,
    single: bool = False,
    origin: str = "",
) -> Files:
    """Write estimator, friction observer and controller as C99, with a test program.

    With numbers of 64 bits the commands are those of the nodes to the last bit.

    Args:
        exported: A loop; or a joint of a joint file, with its observer and controller.
        folder: Where loop.h, loop.c and loop_test.c are written, or axis.h, axis.c, axis_test.c.
        rig: Rig whose calibration of sensors and drive the header of a loop has.
        single: Whether numbers have 32 bits.
        origin: Where the parameters are from, for a comment.

    Raises:
        ParameterError: Something in the loop cannot be exported.
    """
    precision = FLOAT if single else DOUBLE
    if isinstance(exported, JointFile):
        if rig is not None:
            raise ParameterError("a joint has no rig: leave out rig")
        contents = axis_files(exported, precision, origin)
    else:
        contents = loop_files(exported, rig or Rig(), precision, origin)
    written = [Path(folder) / name for name in contents]
    for file, content in zip(written, contents.values(), strict=True):
        _write(file, content)
    return Files(written)


def export_joint(
    joint: JointFile,
    form: str,
    file: str | Path | None = None,
    *,
    prismatic: bool = False,
    lugre: bool = False,
    step: float | None = None,
) -> str:
    """A joint of a joint file as a model for a simulator.

    Args:
        joint: What :func:`furuta.read_joint_file` returned.
        form: urdf, sdf or mjcf.
        file: Where it is written as well.
        prismatic: The joint slides, and its units are N, m, kg and s.
        lugre: With LuGre friction, which only MJCF has.
        step: Time step of MuJoCo [s], by default 1e-3; the shorter it is, the harder the bristle.

    Raises:
        ParameterError: A value is missing or not allowed, or another format has no such option.
    """
    if form not in FORMATS:
        raise ParameterError(f"form must be one of {', '.join(FORMATS)}, given {form}")
    if form != "mjcf" and (lugre or step is not None):
        raise ParameterError(f"{form} has no LuGre friction and no time step, only mjcf has")
    text = joint_model(joint, form, prismatic, lugre, step or 1e-3)
    if file is not None:
        _write(Path(file), text)
    return text


def _write(file: Path, content: str) -> None:
    with whole_file(file) as path:
        path.write_text(content, encoding="utf-8")
