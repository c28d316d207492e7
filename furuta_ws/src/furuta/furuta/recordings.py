"""Recordings and their identification; series as named columns."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from furuta_identification.model import Model
from furuta_model.parameters import ParameterError
from furuta_recordings.recording import Recording
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
    from furuta_recordings import readers

    return readers.read(Path(path), readers.Mapping(arm, pendulum, command, states))


def identify(
    recordings: Recording | Iterable[Recording],
    *,
    zero: str = "auto",
    angles: str = "auto",
    window: float | None = None,
    command_scale: float = 1.0,
) -> Model:
    """Fit one model of pendulum and friction to recordings of a rig.

    Args:
        recordings: One recording, or several of the same rig.
        zero: Where the pendulum's angle is 0: upright, hanging, or auto to detect it.
        angles: Unit of the angles: rad, deg, or auto to detect it.
        window: Length [s] of the segments that are simulated; None chooses it.
        command_scale: Voltage that a command of 1 stands for [V].

    Returns:
        The model; :func:`identified_values` lists its values with standard errors.

    Raises:
        ParameterError: The recordings do not determine a model.
    """
    from furuta_identification.identify import identify as fit
    from furuta_identification.options import Options

    given = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if not given:
        raise ParameterError("recordings must be at least one recording, given none")
    return fit(given, Options(zero, window, angles, command_scale))


def identified_values(model: Model) -> dict[str, Any]:
    """Values and standard errors of an identified model, as ``furuta identify --json`` prints them.

    Args:
        model: What :func:`identify` returned.

    Returns:
        α, β, γ [V s²/rad], δ [V/rad], friction [V, V s/rad] and ``standard_errors`` by name; None
        where the data do not determine a value, with the reason in ``undetermined``.
    """
    from furuta_identification.result.report import summary

    return summary(model)


def load_series(
    path: str | Path,
    *,
    arm: str | None = None,
    pendulum: str | None = None,
    command: str | None = None,
    states: str | None = None,
) -> dict[str, np.ndarray]:
    """The series of a bag or file as columns of equal length, one row per sample.

    Args:
        path: A bag, a file that :func:`write_series` or ``furuta simulate --out`` wrote, or a CSV
            table of another rig.
        arm: Name of the arm's joint, for a recording of another rig.
        pendulum: Name of the pendulum's joint.
        command: Topic or column of the command.
        states: Topic of the joint states.

    Returns:
        Series (n,) by name; :data:`furuta.COLUMNS` has the unit of each. NaN is no value.
        ``pandas.DataFrame(series)`` makes a table of them.

    Raises:
        ParameterError: There is no such file, or it holds no series.
    """
    from furuta.studies import series
    from furuta_recordings import readers

    names = readers.Mapping(arm, pendulum, command, states)
    return series.series_with_findings(Path(path), names)[0]


def simulated_series(record: Record) -> dict[str, np.ndarray]:
    """The series of a simulation as columns.

    Args:
        record: What :func:`furuta.simulate` returned.

    Returns:
        Series (n,) by name; :data:`furuta.COLUMNS` has the unit of each.
    """
    from furuta.studies import series

    return series.simulated_series(record)


def write_series(path: str | Path, columns: Mapping[str, np.ndarray]) -> None:
    """Write series to a file, whose suffix determines its format.

    Args:
        path: A file that ends in .csv, .parquet, .mat (MATLAB) or .npz; it is replaced.
        columns: Series (n,) by name, of equal length, as :func:`load_series` returns them.

    Raises:
        ParameterError: The suffix is another one, or Parquet is not installed.
    """
    from furuta_recordings.table_files import write_columns

    write_columns(Path(path), columns)
