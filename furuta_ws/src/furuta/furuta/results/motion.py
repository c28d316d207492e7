"""Simulated runs."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from furuta.oscillation import Oscillation, has_fallen
from furuta.outcomes import NO_MEANING, Outcome, outcome_of
from furuta.results.result import Result
from furuta.results.table import Series
from furuta_model.state import RIGID_STATES
from furuta_recordings.series_columns import MEASURED, known, series_of
from furuta_recordings.table_files import write_npz
from furuta_ros.whole_files import whole_file
from furuta_sim.simulation.closed_loop import Loop, Record


@dataclass(frozen=True, repr=False, eq=False)
class Run(Result):
    """Series of a simulation, one row per sample of ``sample_time`` [s].

    Fields: ``time`` (n,) [s], ``state`` (n, 4) true x, ``estimate`` (n, 5) of x, then the torque as
    measured [V], ``friction`` (n,) true F [V], ``friction_estimate`` (n,) F̂ [V], ``command`` (n,)
    u [V], ``measurement`` (n, 5) of x, NaN where there is no sensor, and of the torque applied [V].
    """

    details = frozenset({each.name for each in fields(Outcome)} - {*Oscillation._fields, "fell"})

    sample_time: float
    state: np.ndarray
    estimate: np.ndarray
    friction: np.ndarray
    friction_estimate: np.ndarray
    command: np.ndarray
    measurement: np.ndarray
    loop: Loop

    @property
    def record(self) -> Record:
        """The series as compiled code takes them."""
        return Record(*(getattr(self, name) for name in Record._fields))

    @property
    def time(self) -> np.ndarray:
        """Time of each sample (n,) [s]."""
        return self.record.time

    @cached_property
    def outcome(self) -> Outcome:
        """What :func:`furuta.measure` returns of the same run."""
        return outcome_of([self.record], self.loop.plant, len(self.command))

    @cached_property
    def fell_at(self) -> float:
        """When the pendulum was first below the horizontal [s]; NaN if never."""
        below = np.flatnonzero(has_fallen(self.state))
        return float(below[0]) * self.sample_time if len(below) else float("nan")

    def _by_name(self) -> dict[str, Any]:
        """What is measured in the second half, and whether the pendulum fell in the whole run."""
        return self.outcome._by_name()

    def sentence(self) -> str:
        """How the arm swings in the second half, or when the pendulum fell."""
        if not np.isnan(self.fell_at):
            return f"The pendulum fell after {self.fell_at:.3g} s{self._why()}. {NO_MEANING}"
        return self.outcome.sentence()

    def _why(self) -> str:
        """Why the pendulum fell, if that is evident."""
        friction = self.loop.plant.friction.parameters.alpha0
        limit = self.loop.controller.voltage_limit
        too_much = f": alpha0, {friction:g} V, exceeds the drive's {limit:g} V"
        return too_much * (friction > limit)

    def series(self) -> Series:
        """The series as columns (n,), each with its unit in its name."""
        return simulated_series(self.record)

    def write(self, path: str | Path) -> None:
        """Write the series; the suffix determines the format.

        Args:
            path: A file that ends in .csv, .parquet or .mat, with the columns of :meth:`series`; or
                in .npz, with the arrays of the run and its drive.

        Raises:
            ParameterError: The suffix is another one, or Parquet is not installed.
        """
        path = Path(path)
        if path.suffix.lower() != ".npz":
            self.series().write(path)
            return
        drive, (_, *series) = np.array(self.loop.plant.actuator), self.record
        named = dict(zip(Record._fields[1:], series, strict=True))
        with whole_file(path) as new:
            write_npz(new, {"time": self.time, "drive": drive, **named})

    def plot(self, axes: Any = None) -> Any:
        """Draw the series over time; see :meth:`Result.plot`."""
        return self.series().plot(axes)


def simulated_series(record: Record) -> Series:
    """The series of a simulation as columns."""
    columns = series_of(
        record.time,
        record.measurement,
        record.estimate[:, :RIGID_STATES],
        record.friction_estimate,
        record.command,
        np.column_stack([record.state, record.friction]),
    )
    without_sensor = MEASURED.keys() - known(columns).keys()
    return Series({name: each for name, each in columns.items() if name not in without_sensor})
