"""Tables: columns (n,) by name, which pandas takes in one call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from furuta.results.plain import plain
from furuta.results.result import Result
from furuta.results.text import WIDTH, table_text, unit_of
from furuta_model.optional import missing
from furuta_model.parameters import ParameterError
from furuta_recordings.series_columns import TIME
from furuta_recordings.table_files import write_columns

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset

# Rows of a table that are printed.
SHOWN = 10


class Table(dict[str, np.ndarray], Result):
    """Columns (n,) by name, in which NaN is no value. The name of a column ends in its unit."""

    __repr__ = Result.__repr__

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(next(iter(self.values()), ()))

    def row(self, number: int) -> dict[str, Any]:
        """A row by the names of the columns; None is no value."""
        return {name: plain(column[number]) for name, column in self.items()}

    def _by_name(self) -> dict[str, Any]:
        """The columns as lists."""
        return dict(self)

    def sentence(self) -> str:
        """How large the table is."""
        return f"{self.rows} rows, {len(self)} columns"

    def dictionaries(self, number: int | None = None) -> list[dict[str, Any]]:
        """The first rows, by default all, each by the names of the columns."""
        return [self.row(k) for k in range(self.rows)[:number]]

    def report(self) -> str:
        """The size and the first rows."""
        return self.text(self.dictionaries(SHOWN), self.rows, {name: name for name in self})

    def text(
        self, rows: Sequence[Mapping[str, Any]], number: int, headings: Mapping[str, str]
    ) -> str:
        """The sentence and some of a ``number`` of rows."""
        more = "\n..." if number > len(rows) else ""
        parts = fill(self.sentence(), WIDTH), table_text(rows, headings) + more
        return "\n\n".join(filter(None, parts))

    def write(self, path: str | Path) -> None:
        """Write the columns to a file, whose suffix determines its format.

        Args:
            path: A file that ends in .csv, .parquet, .mat (MATLAB) or .npz; it is replaced.

        Raises:
            ParameterError: The suffix is another one, Parquet is not installed, or the columns have
                different lengths.
        """
        write_columns(Path(path), self)

    @property
    def units(self) -> dict[str, str]:
        """The units of the columns that have one, by the end of a name or of a parameter."""
        from furuta.settings.parameter_names import declared_unit

        return {name: unit for name in self if (unit := unit_of(name) or declared_unit(name))}

    def to_pandas(self) -> DataFrame:
        """The columns as a data frame, of which ``attrs["units"]`` is :attr:`units`.

        Raises:
            ParameterError: pandas is not installed.
        """
        try:
            from pandas import DataFrame
        except ImportError:
            raise ParameterError(missing("pandas", "to_pandas")) from None
        frame = DataFrame(dict(self))
        frame.attrs["units"] = self.units
        return frame

    def to_xarray(self) -> Dataset:
        """The columns as a dataset over time, or over rows if there is none.

        The attribute ``units`` of a variable is its unit.

        Raises:
            ParameterError: xarray is not installed.
        """
        try:
            from xarray import Dataset
        except ImportError:
            raise ParameterError(missing("xarray", "to_xarray")) from None
        over, units = TIME if TIME in self else "row", self.units
        attributes = {name: {"units": units[name]} if name in units else {} for name in self}
        return Dataset({name: (over, self[name], attributes[name]) for name in self})


class Series(Table):
    """Series over time; ``furuta_recordings.series_columns`` says what each column is."""

    def plot(self, axes: Any = None) -> Any:
        """Draw the quantities that exist over time; see :meth:`Result.plot`."""
        from furuta.figures.series import draw_series

        return draw_series(self, axes)
