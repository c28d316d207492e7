"""Recordings of rigs; series as named columns."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from furuta.results.motion import simulated_series
from furuta.results.table import Series
from furuta_model.parameters import ParameterError
from furuta_model.state import RIGID_STATES
from furuta_recordings.readers import Mapping as Names
from furuta_recordings.readers import is_bag, read
from furuta_recordings.recording import Recording
from furuta_recordings.series_columns import (
    ANGLES,
    COLUMNS,
    COMMAND,
    MEASURED,
    TIME,
    by_name,
    known,
    series_of,
)
from furuta_recordings.table_files import SUFFIXES, read_columns
from furuta_ros import topics
from furuta_sim.simulation.closed_loop import Record


def read_recording(
    path: str | Path,
    *,
    arm: str | None = None,
    pendulum: str | None = None,
    command: str | None = None,
    states: str | None = None,
) -> Recording:
    """A recording of any rig, from a bag, a CSV table or a file of ``furuta simulate --out``.

    Args:
        path: The recording.
        arm: Name of the arm's joint, if it is not found by itself.
        pendulum: Name of the pendulum's joint.
        command: Topic or column of the command, or ``effort`` for the arm's effort.
        states: Topic of the joint states.

    Returns:
        ``time`` (n,) [s], ``measured`` (n, 4) [rad, rad/s] in the recording's own units and
        orientation, ``command_time`` (m,) [s], ``command`` (m,) [V].

    Raises:
        ParameterError: The file cannot be read, or a name is missing or ambiguous.
    """
    return read(Path(path), Names(arm, pendulum, command, states))


def load_series(
    path: str | Path,
    *,
    arm: str | None = None,
    pendulum: str | None = None,
    command: str | None = None,
    states: str | None = None,
) -> Series:
    """The series of a bag or file as columns of equal length, one row per sample.

    Args:
        path: A bag, a file that ``furuta simulate --out`` or :meth:`Series.write` wrote, or a CSV
            table of another rig.
        arm: Name of the arm's joint, for a recording of another rig.
        pendulum: Name of the pendulum's joint.
        command: Topic or column of the command.
        states: Topic of the joint states.

    Returns:
        Series (n,) by name, which ends in the unit. NaN is no value.

    Raises:
        ParameterError: There is no such file, or it holds no series.
    """
    return series_with_findings(Path(path), Names(arm, pendulum, command, states))[0]


def series_with_findings(path: Path, names: Names | None = None) -> tuple[Series, list[str]]:
    """The columns of a file, bag or table, and how a recording was interpreted.

    Bags of the graph give measurement, estimates, command and, from a simulated plant, the truth.
    Of another rig's bag or CSV table, ``names`` tells the joints and the command; it gives the
    measured columns and the command.

    Raises:
        ParameterError: There is no such file, or it holds no series.
    """
    names = names or Names()
    if not path.exists():
        raise ParameterError(f"no file or bag {path}")
    if is_bag(path):
        return _bag_series(path, names)
    columns = read_columns(path) if path.suffix.lower() in SUFFIXES else {}
    if names == Names() and TIME in columns and columns.keys() & ANGLES:
        chosen = {name: columns[name] for name in COLUMNS if name in columns}
        if any(values.shape != (len(chosen[TIME]),) for values in chosen.values()):
            raise ParameterError(f"{path}: its series have different lengths")
        return Series(chosen), []
    if names == Names() and {"state", "estimate", "time"} <= columns.keys():
        return _simulation_file(path, columns), []
    return _recorded_series(read(path, names))


def _simulation_file(path: Path, columns: Mapping[str, np.ndarray]) -> Series:
    """The columns of a file that ``furuta simulate --out FILE.npz`` wrote."""
    try:
        time = columns["time"]
        record = Record(
            float(time[1] - time[0]) if len(time) > 1 else 0.0,
            *(columns[name] for name in Record._fields[1:]),
        )
        return Series({**simulated_series(record), TIME: time})
    except (KeyError, ValueError, IndexError, TypeError) as error:
        raise ParameterError(f"{path} is not a file of `furuta simulate --out`: {error}") from None


def _bag_series(path: Path, names: Names) -> tuple[Series, list[str]]:
    """The columns of a bag of the graph, or of another rig's if there are ``names``."""
    from furuta_recordings.bags.bag import Bag
    from furuta_recordings.bags.recorded_loop import graph_topics, read_recorded_loop

    with Bag(path) as bag:
        of_graph = bool(graph_topics(path, bag))
    if not of_graph or names != Names():
        return _recorded_series(read(path, names))
    recorded = read_recorded_loop(path)
    columns = series_of(
        recorded.time,
        recorded.measurement,
        recorded.estimate[:, :RIGID_STATES],
        recorded.at_measurements(topics.FRICTION_ESTIMATE.name),
        recorded.at_measurements(topics.COMMAND.name),
        recorded.truth,
    )
    return Series(known(columns)), []


def _recorded_series(recording: Recording) -> tuple[Series, list[str]]:
    """The columns of a recording of any rig; the command is the one that held at each sample."""
    missing = np.full((len(recording.time), 1), np.nan)
    measured = by_name(MEASURED, np.hstack([recording.measured, missing]))
    command = recording.commanded_at(recording.time)
    if not len(recording.command):
        command = missing[:, 0]
    columns = known({TIME: recording.time, **measured, COMMAND: command})
    return Series(columns), list(recording.findings)
