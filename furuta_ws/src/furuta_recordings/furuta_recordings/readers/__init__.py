"""Readers of recordings: bags, tables, and files of ``furuta simulate``; without ROS."""

from pathlib import Path

from furuta_model.parameters import ParameterError
from furuta_recordings.readers.bag import read_bag
from furuta_recordings.readers.mapping import Mapping
from furuta_recordings.readers.simulation import is_simulation, read_simulation
from furuta_recordings.readers.table import read_table
from furuta_recordings.readers.times import with_usable_times
from furuta_recordings.recording import Recording

__all__ = ["Mapping", "is_bag", "read"]


def is_bag(path: Path) -> bool:
    """Whether a path is that of a bag."""
    return path.is_dir() or path.suffix in (".mcap", ".db3")


def read(path: Path, mapping: Mapping) -> Recording:
    """A recording with its angles as recorded."""
    if not path.exists():
        raise ParameterError(f"no recording {path}")
    if is_simulation(path):
        return with_usable_times(read_simulation(path))
    read_one = read_bag if is_bag(path) else read_table
    return with_usable_times(read_one(path, mapping))
