"""Readers of recordings: bags, tables, and files of ``furuta simulate``; without ROS."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.bag_files import is_bag
from furuta_recordings.readers.mapping import Mapping

if TYPE_CHECKING:
    from furuta_recordings.recording import Recording

__all__ = ["Mapping", "is_bag", "read", "read_axis"]

# Options need only the names above, and no table needs the library for bags: modules that need
# libraries are imported where they are used.


def read(path: Path, mapping: Mapping) -> Recording:
    """A recording with its angles as recorded."""
    from furuta_recordings.readers import table
    from furuta_recordings.readers.times import with_usable_times

    if not path.exists():
        raise ParameterError(f"no recording {path}")
    if table.is_simulation(path):
        _refuse(
            path, mapping, mapping._fields, "the arrays of a simulation have names of their own"
        )
        return with_usable_times(table.read_simulation(path))
    if is_bag(path):
        from furuta_recordings.readers.bag import read_bag

        _refuse(path, mapping, ("time", "columns", "rate"), "a bag has no columns")
        return with_usable_times(read_bag(path, mapping))
    _refuse(path, mapping, ("states",), "a table has no topics")
    return with_usable_times(table.read_table(path, mapping))


def _refuse(path: Path, mapping: Mapping, names: Iterable[str], reason: str) -> None:
    """Raise if the user gives one of the names, which has no effect on such a file."""
    for name in names:
        if getattr(mapping, name) is not None:
            raise ParameterError(f"{path}: {reason}; leave out --{name}")


def read_axis(
    path: str | Path,
    position: str | None = None,
    command: str | None = None,
    torque_constant: float = 1.0,
    joint: str | None = None,
    time: str | None = None,
    lead: float = 0.0,
    columns: str | None = None,
    rate: float | None = None,
) -> Recording:
    """The recording of an axis: its position as arm angle [rad or m], its torque as command.

    Args:
        path: A table or a bag.
        position: Column of the position, if its name is not a usual one.
        command: Column or topic of what drives the axis; of a bag by default the joint's effort;
            "none" reads the position alone.
        torque_constant: Torque or force that a command of 1 V, A or N m stands for.
        joint: Joint in a bag, or in a table with several; needed if there are several.
        time: Column of the time, if its name is not a usual one.
        lead: Way [m] per turn of the motor, if the position is a length and the drive a torque.
        columns: Names of the columns, separated by commas, of a table without a header.
        rate: Rows per second [Hz] of a table without times.

    Raises:
        ParameterError: The file cannot be read, or a name is missing or ambiguous.
    """
    from furuta_model.state import PHI
    from furuta_recordings.cleaning import FEWEST_SAMPLES, with_usable_samples
    from furuta_recordings.readers.times import with_usable_times

    path = Path(path)
    if not path.exists():
        raise ParameterError(f"no recording {path}")
    if is_bag(path):
        from furuta_recordings.readers.bag import read_bag_axis

        if any(each is not None for each in (position, time, columns, rate)):
            raise ParameterError(f"{path}: a bag has no columns; name its joint with --joint")
        recording = read_bag_axis(path, joint, command)
    else:
        from furuta_recordings.readers.table import read_axis_table

        mapping = Mapping(command=command, time=time, columns=columns, rate=rate)
        recording = read_axis_table(path, position, joint, mapping)
        recording = recording._replace(joint=joint or path.stem)
    recording = _in_units_of_an_axis(recording, torque_constant, lead)
    fewest = min(FEWEST_SAMPLES, len(recording.time))
    return with_usable_samples(with_usable_times(recording), (PHI,), fewest)


def _in_units_of_an_axis(recording: Recording, torque_constant: float, lead: float) -> Recording:
    """With the drive's torque or force for its command, and turns of the motor for a way.

    Raises :class:`ParameterError` for a length with a torque, without the lead between them.
    """
    from math import pi

    from furuta_model.state import PHI, PHI_DOT

    position, drive = recording.units
    if lead and position != "m":
        raise ParameterError(
            f"{recording.name}: a lead turns a position in m into turns; the position is in "
            f"{position}"
        )
    if lead:
        measured = recording.measured.copy()
        measured[:, [PHI, PHI_DOT]] *= 2.0 * pi / lead
        unit, size = recording.position_unit
        turned = unit, 2.0 * pi / lead * size
        recording, position = recording._replace(measured=measured, position_unit=turned), "rad"
    if torque_constant != 1.0:
        drive = "N" if position == "m" else "N m"
    elif position == "m" and drive == "N m":
        raise ParameterError(
            f"{recording.name}: the position is a length, the drive a torque; give the way per "
            "turn of the motor (--lead 10mm), or the force per torque (--torque-constant)"
        )
    elif position == "rad" and drive == "N":
        raise ParameterError(
            f"{recording.name}: the position is an angle, the drive a force; give the torque per "
            "force, which is the radius (--torque-constant)"
        )
    command = torque_constant * recording.command
    return recording._replace(command=command, units=(position, drive))
