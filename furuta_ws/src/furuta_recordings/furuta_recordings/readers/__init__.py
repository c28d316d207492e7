"""Readers of recordings: bags, tables, and files of ``furuta simulate``; without ROS."""

from __future__ import annotations

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
        return with_usable_times(table.read_simulation(path))
    if is_bag(path):
        from furuta_recordings.readers.bag import read_bag

        return with_usable_times(read_bag(path, mapping))
    return with_usable_times(table.read_table(path, mapping))


def read_axis(
    path: str | Path,
    position: str | None = None,
    command: str | None = None,
    torque_constant: float = 1.0,
    joint: str | None = None,
) -> Recording:
    """The recording of an axis: its position as arm angle [rad or m], its torque as command.

    Args:
        path: A table or a bag.
        position: Column of the position, if its name is not a usual one.
        command: Column or topic of what drives the axis; of a bag by default the joint's effort.
        torque_constant: Torque or force that a command of 1 V, A or N m stands for.
        joint: Joint in a bag, or in a table with several; needed if there are several.

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

        if position is not None:
            raise ParameterError(f"{path}: a bag has no columns; name its joint with --joint")
        recording = read_bag_axis(path, joint, command)
    else:
        from furuta_recordings.readers.table import read_axis_table

        recording = read_axis_table(path, position, command, joint)
        recording = recording._replace(joint=joint or path.stem)
    recording = recording._replace(command=torque_constant * recording.command)
    fewest = min(FEWEST_SAMPLES, len(recording.time))
    return with_usable_samples(with_usable_times(recording), (PHI,), fewest)
