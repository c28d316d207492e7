"""Simulated runs and what is measured of them."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from furuta.oscillation import Oscillation, has_fallen
from furuta.outcomes import Outcome as Measured
from furuta.outcomes import outcome_of
from furuta.results.result import Found
from furuta.results.table import Series
from furuta.results.text import swing_sentence
from furuta_model.state import RIGID_STATES
from furuta_recordings.series_columns import MEASURED, known, series_of
from furuta_recordings.table_files import write_npz
from furuta_ros.whole_files import whole_file
from furuta_sim.simulation.closed_loop import Loop, Record

NO_MEANING = "The other values mean nothing."


class Outcome(Found):
    """What was measured of a run in its settled part; ``fell`` refers to the whole run.

    Fields: ``phi_peak_to_peak_rad``, ``theta_peak_to_peak_rad``, ``period_s`` (NaN without one),
    ``stuck_fraction`` (NaN without friction), ``phi_rms_rad``, ``command_rms_v``,
    ``command_step_v``, ``command_high_frequency_v``, ``friction_error_rms_v``, ``fell``, ``steps``.
    """

    found: Measured
    details = frozenset({"steps"})

    def sentence(self) -> str:
        """How the arm swings."""
        if self.found.fell:
            return f"The pendulum fell. {NO_MEANING}"
        return swing_sentence(*self.found[:1], *self.found[2:4])


class Run(Found):
    """Series of a simulation, one row per sample of ``sample_time`` [s].

    Fields: ``time`` (n,) [s], ``state`` (n, 4) true x, ``estimate`` (n, 5) of x, then the torque as
    measured [V], ``friction`` (n,) true F [V], ``friction_estimate`` (n,) F̂ [V], ``command`` (n,)
    u [V], ``measurement`` (n, 5) of x, NaN where there is no sensor, and of the torque applied [V].
    """

    found: Record
    details = frozenset({*Measured._fields} - {*Oscillation._fields, "fell"})

    def __init__(self, found: Record, loop: Loop) -> None:
        super().__init__(found)
        self.loop = loop

    @cached_property
    def outcome(self) -> Outcome:
        """What :func:`furuta.measure` returns of the same run."""
        record = self.found
        return Outcome(outcome_of([record], self.loop.plant, len(record.command)))

    @cached_property
    def fell_at(self) -> float:
        """When the pendulum was first below the horizontal [s]; NaN if never."""
        below = np.flatnonzero(has_fallen(self.found.state))
        return float(below[0]) * self.found.sample_time if len(below) else float("nan")

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
        return simulated_series(self.found)

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
        record, drive = self.found, np.array(self.loop.plant.actuator)
        fields = {name: each for name, each in record._asdict().items() if name != "sample_time"}
        with whole_file(path) as new:
            write_npz(new, {"time": record.time, "drive": drive, **fields})

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
