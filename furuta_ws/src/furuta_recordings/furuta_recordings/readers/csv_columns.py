"""Reads the columns of a CSV table as numbers."""

from __future__ import annotations

import csv
from math import nan
from pathlib import Path
from typing import Any

import numpy as np

from furuta_model.parameters import ParameterError


def csv_columns(path: Path) -> dict[str, np.ndarray]:
    """Every named column (n,); NaN where a cell is empty or not a number."""
    header, rows = _cells(path)
    if not header or not rows:
        raise ParameterError(f"{path}: no table in it")
    return {
        name: np.array([_number(row, index) for row in rows])
        for index, name in enumerate(header)
        if name
    }


def _cells(path: Path) -> tuple[list[str], list[list[str]]]:
    """Header and rows."""
    try:
        with path.open(newline="") as file:
            dialect = _dialect(file.read(4096))
            file.seek(0)
            reader = csv.reader(file, dialect)
            header = [name.strip() for name in next(reader, [])]
            return header, [row for row in reader if row]
    except UnicodeDecodeError:
        raise ParameterError(f"cannot read {path}: not a text file") from None
    except (OSError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or error
        raise ParameterError(f"cannot read {path}: {reason}") from None


def _dialect(text: str) -> Any:
    """Comma, semicolon or tab, as the first line has it."""
    try:
        return csv.Sniffer().sniff(text.splitlines()[0], ",;\t")
    except (csv.Error, IndexError):
        return csv.excel


def _number(row: list[str], index: int) -> float:
    try:
        return float(row[index])
    except (ValueError, IndexError):
        return nan
