"""Types of options beyond those of click: files to write, and finite numbers."""

import math
from pathlib import Path
from typing import Any

import click

from furuta_model.parameters import number_hint
from furuta_recordings.suffixes import SUFFIXES, TABLE_SUFFIXES

# A file or directory that a verb reads or writes.
PATH = click.Path(path_type=Path)
DIRECTORY = click.Path(path_type=Path, file_okay=False)


class OutputFile(click.Path):
    """A file to write, whose suffix determines its format."""

    def __init__(self, *suffixes: str) -> None:
        super().__init__(dir_okay=False, path_type=Path)
        self.suffixes = suffixes

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        """What help shows for the value."""
        return f"FILE.({'|'.join(suffix[1:] for suffix in self.suffixes)})"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """The path."""
        path = Path(str(super().convert(value, param, ctx)))
        if path.suffix.lower() not in self.suffixes:
            self.fail(f"{value} does not end in {', '.join(self.suffixes)}.", param, ctx)
        return path


FIGURE_SUFFIXES = (".png", ".pdf", ".svg")
FIGURE = OutputFile(*FIGURE_SUFFIXES)
PARAMETER_FILE = OutputFile(".yaml", ".yml")
TABLE = OutputFile(*TABLE_SUFFIXES)
SERIES = OutputFile(*SUFFIXES)


class FiniteRange(click.FloatRange):
    """A range of finite numbers: unlike click's own it rejects NaN."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """The number."""
        try:
            float(value)
        except ValueError:
            self.fail(f"{value!r} is not a number{number_hint(value)}.", param, ctx)
        number = float(super().convert(value, param, ctx))
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number.", param, ctx)
        return number

    def _describe_range(self) -> str:  # click's own says "x<=None" of a range without ends
        return super()._describe_range() if self.min != self.max else ""
