"""Tables of series: written and read in every format, and refused with one line."""

import csv
from math import isnan, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import loadmat

from furuta_model.parameters import ParameterError
from furuta_recordings import table_files
from furuta_recordings.table_files import SUFFIXES, read_columns, write_columns

COLUMNS = {"time_s": np.array([0.0, 0.1, 1 / 3]), "command_v": np.array([nan, -1e-7, 2e22])}


@pytest.mark.parametrize("suffix", [*SUFFIXES, ".CSV"])
def test_what_is_written_comes_back(tmp_path: Path, suffix: str) -> None:
    """To the last bit, NaN too, in the same order; an existing file is replaced."""
    if suffix == ".parquet":
        pytest.importorskip("pyarrow")
    path = tmp_path / "new" / f"table{suffix}"
    for _ in range(2):
        write_columns(path, COLUMNS)
    again = read_columns(path)
    assert list(again) == list(COLUMNS)
    assert all(np.array_equal(again[n], COLUMNS[n], equal_nan=True) for n in COLUMNS)


def test_other_programs_read_them(tmp_path: Path) -> None:
    """CSV by Python's own reader, with the shortest digits; MATLAB files hold column vectors."""
    write_columns(tmp_path / "table.csv", COLUMNS)
    with (tmp_path / "table.csv").open() as file:
        header, first, second, _ = csv.reader(file)
    assert header == list(COLUMNS)
    assert isnan(float(first[1]))
    assert second == ["0.1", "-1e-07"]
    write_columns(tmp_path / "table.mat", COLUMNS)
    assert loadmat(tmp_path / "table.mat")["time_s"].shape == (3, 1)


@pytest.mark.parametrize("suffix", [".parquet", ".mat", ".npz"])
def test_a_file_of_another_kind_is_one_line(tmp_path: Path, suffix: str) -> None:
    """Whatever the library raises."""
    if suffix == ".parquet":
        pytest.importorskip("pyarrow")
    (tmp_path / f"table{suffix}").write_bytes(b"\0\1\2not a table" * 20)
    with pytest.raises(ParameterError, match="table") as caught:
        read_columns(tmp_path / f"table{suffix}")
    assert len(str(caught.value).splitlines()) == 1


def test_pickles_and_huge_series_are_refused(tmp_path: Path, monkeypatch: Any) -> None:
    """A file from elsewhere neither runs code nor fills the memory."""
    path = tmp_path / "table.npz"
    np.savez(path, text=np.array([{"a": 1}], dtype=object))
    with pytest.raises(ParameterError, match="pickle"):
        read_columns(path)
    np.savez(path, text=np.array(["word"]))
    with pytest.raises(ParameterError, match="not numbers"):
        read_columns(path)
    pytest.importorskip("pyarrow")
    for suffix in (".npz", ".mat", ".parquet"):
        write_columns(tmp_path / f"large{suffix}", {"a": np.zeros(1000), "b": np.zeros(1000)})
    monkeypatch.setattr(table_files, "LARGEST_CONTENT", 15_999)
    for suffix in (".npz", ".mat", ".parquet"):
        with pytest.raises(ParameterError, match=r"holds 16\d\d\d bytes, at most 15999 are read"):
            read_columns(tmp_path / f"large{suffix}")
