"""Readers of recordings: bags, tables, and files of ``furuta simulate``; without ROS."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from furuta_model.parameters import ParameterError
from furuta_recordings.readers.mapping import Mapping

if TYPE_CHECKING:
    from furuta_recordings.recording import Recording

__all__ = ["Mapping", "is_bag", "read"]


def is_bag(path: Path) -> bool:
    """Whether a path is that of a bag."""
    return path.is_dir() or path.suffix in (".mcap", ".db3")


def read(path: Path, mapping: Mapping) -> Recording:
    """A recording with its angles as recorded."""
    # Options need only the names above, and no table needs the library for bags.
    from furuta_recordings.readers import simulation, table
    from furuta_recordings.readers.times import with_usable_times

    if not path.exists():
        raise ParameterError(f"no recording {path}")
    if simulation.is_simulation(path):
        return with_usable_times(simulation.read_simulation(path))
    if is_bag(path):
        from furuta_recordings.readers.bag import read_bag

        return with_usable_times(read_bag(path, mapping))
    return with_usable_times(table.read_table(path, mapping))
