"""Points and table of a sweep."""

import sys
from pathlib import Path
from typing import Any

import pytest

from furuta.studies.study_tables import OUTCOME, check_table, write_runs
from furuta.studies.sweep import SweptParameter, parse_swept_parameter
from furuta_model.parameters import ParameterError
from furuta_recordings import table_files


def rows(count: int) -> Any:
    """Runs, the first one impossible."""
    outcome = {name: kind(1) for name, kind in OUTCOME.items()} | {"error": ""}
    for number in range(count):
        none = dict.fromkeys(OUTCOME) | {"error": "too stiff"}
        yield {"rig": number, "alpha0": 0.1 * number, "law": "lugre"} | (
            outcome if number else none
        )


def test_parquet_has_types_and_empty_values(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also if no value of a column is in the first rows; written in groups."""
    parquet = pytest.importorskip("pyarrow.parquet")
    monkeypatch.setattr(table_files, "ROWS_TOGETHER", 4)
    write_runs(rows(10), tmp_path / "a.parquet")
    assert parquet.ParquetFile(tmp_path / "a.parquet").num_row_groups == 3
    table = parquet.read_table(tmp_path / "a.parquet")
    assert table.to_pylist() == list(rows(10))
    assert str(table.schema.field("fell").type) == "bool"
    assert str(table.schema.field("steps").type) == "int64"


def test_a_table_is_checked_before_the_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.csv").touch()
    with pytest.raises(ParameterError, match="already exists"):
        check_table(tmp_path / "a.csv")
    for name in ("a.mat", "a.npz", "a.xlsx", "a"):
        with pytest.raises(ParameterError, match=r"does not end in \.csv, \.parquet"):
            check_table(tmp_path / name)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ParameterError, match="need pyarrow"):
        check_table(tmp_path / "a.parquet")


def test_swept_parameters_are_parsed() -> None:
    """Ranges of numbers, integers for integer parameters, and lists of anything."""
    assert parse_swept_parameter("alpha0=0.1:0.3:3", 9).values == pytest.approx((0.1, 0.2, 0.3))
    assert parse_swept_parameter("alpha0=0.1:0.3", 9).values[4] == pytest.approx(0.2)
    assert parse_swept_parameter("plant.seed=0:4:5", 9).values == (0, 1, 2, 3, 4)
    assert parse_swept_parameter("compensation=coulomb,lugre", 9) == SweptParameter(
        "compensation", ("coulomb", "lugre")
    )
