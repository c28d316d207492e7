"""Writes and reads tables of series as CSV, Parquet, MATLAB or npz files; the suffix decides."""

import csv
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import islice
from math import prod
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, BadZipFile, ZipFile

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_recordings.csv_columns import Table, read_csv
from furuta_recordings.suffixes import SUFFIXES
from furuta_ros.whole_files import whole_file

# Largest content of a file that is read [bytes]: an hour and a quarter of 14 columns at 1 kHz.
LARGEST_CONTENT = 2**29
# Rows of a Parquet file that are written together.
ROWS_TOGETHER = 65_536
# Types of their columns.
_ARROW = {float: "float64", int: "int64", bool: "bool", str: "string"}

# Series by name, all of the same length.
Columns = Mapping[str, np.ndarray]


def write_columns(path: Path, columns: Columns) -> None:
    """Write series (n,) of equal length; an existing file is replaced.

    Raises:
        ParameterError: The suffix is none of :data:`SUFFIXES`, Parquet is not installed, or the
            series have different lengths.
        UserError: The file cannot be written.
    """
    write, _ = _format(path)
    shapes = {np.shape(values) for values in columns.values()}
    if any(len(shape) != 1 for shape in shapes) or len(shapes) != 1:
        given = shapes or "none"
        raise ParameterError(f"series for {path} must have one and the same length, given {given}")
    with whole_file(path) as new:
        write(new, {name: np.ascontiguousarray(values) for name, values in columns.items()})


def read_columns(path: Path) -> dict[str, np.ndarray]:
    """The series of a file that :func:`write_columns` wrote, or of any table in such a format.

    Raises:
        ParameterError: The file cannot be read, or its suffix is none of :data:`SUFFIXES`.
    """
    _format(path)  # raises an error for another suffix
    content = _read(path)
    if isinstance(content, Table):
        return content.columns
    numbers = {name: np.asarray(s, float) for name, s in content.items() if _is_numeric(s)}
    if content and not numbers:
        raise ParameterError(f"{path}: {', '.join(content)} are not numbers")
    return numbers


def read_table(path: Path, names: Sequence[str] = (), rate: float | None = None) -> Table:
    """The columns of any table, of CSV if the suffix is unknown; raises ParameterError.

    A table without a header has these ``names``, one without times a ``rate`` [Hz] of its rows.
    """
    content = _read(path, names)
    table = content if isinstance(content, Table) else tabulated(path, content)
    if rate is None:
        return table
    if "time" in table.columns:
        raise ParameterError(f"{path} has a column time: leave out --rate")
    rows = len(next(iter(table.columns.values())))
    return table._replace(columns={"time": np.arange(rows) / rate, **table.columns})


def _read(path: Path, names: Sequence[str] = ()) -> Any:
    read = _format(path)[1] if path.suffix.lower() in SUFFIXES else read_csv
    if names:
        if read is not read_csv:
            raise ParameterError(f"{path} has names of its own: leave out --columns")
        read = partial(read_csv, names=names)
    if not path.is_file():
        raise ParameterError(f"no file {path}")
    try:
        return read(path)
    except ParameterError:
        raise
    except Exception as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ParameterError(f"cannot read {path}: {reason}") from None


def _format(path: Path) -> tuple[Callable[[Path, Columns], None], Callable[[Path], Any]]:
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise ParameterError(f"{path} does not end in {', '.join(SUFFIXES)}")
    if suffix == ".parquet":
        parquet_library()
    return _FORMATS[suffix]


def parquet_library() -> tuple[Any, Any]:
    """Pyarrow and its module for Parquet files; raises ParameterError if they cannot be used."""
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError as error:
        fitting = "'pyarrow<26'" if np.__version__ < "2" else "pyarrow"  # 26 needs numpy 2
        raise ParameterError(
            f"Parquet files need pyarrow ({error}): pip install {fitting}"
        ) from None
    return pyarrow, parquet


def _write_csv(path: Path, columns: Columns) -> None:
    """Numbers have the fewest digits from which they are read back exactly."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(zip(*(each.tolist() for each in columns.values()), strict=True))


def write_parquet_rows(
    path: Path, types: Mapping[str, type], rows: Iterable[Mapping[str, Any]]
) -> None:
    """Write rows to a Parquet file, some at a time; ``types`` (float, int, bool, str) by column."""
    arrow, parquet = parquet_library()
    schema = arrow.schema([(name, _ARROW[kind]) for name, kind in types.items()])
    iterator = iter(rows)
    with parquet.ParquetWriter(path, schema) as writer:
        while group := list(islice(iterator, ROWS_TOGETHER)):
            columns = {name: [row[name] for row in group] for name in types}
            writer.write_table(arrow.table(columns, schema))


def _write_parquet(path: Path, columns: Columns) -> None:
    arrow, parquet = parquet_library()
    parquet.write_table(arrow.table(columns), path)


def _read_parquet(path: Path) -> dict[str, np.ndarray]:
    _, parquet = parquet_library()
    about = parquet.ParquetFile(path).metadata
    _check_size(path, 8 * about.num_rows * about.num_columns)
    table = parquet.read_table(path)
    columns = {name: table[name].to_numpy() for name in table.column_names}
    return {name: values for pair in columns.items() for name, values in _elements(*pair)}


def _elements(name: str, values: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """A column, or one for each element of its lists, if they have one length."""
    is_list = values.dtype.kind == "O" and all(isinstance(each, np.ndarray) for each in values)
    if not is_list or len({each.shape for each in values}) != 1 or values[0].ndim != 1:
        yield name, values
        return
    for k, column in enumerate(np.stack(list(values)).T):
        yield f"{name}[{k}]", column


def _write_matlab(path: Path, columns: Columns) -> None:
    from scipy.io import savemat

    savemat(path, columns, appendmat=False, do_compression=True, oned_as="column")


def _read_matlab(path: Path) -> dict[str, np.ndarray]:
    from scipy.io import loadmat, whosmat

    try:
        _check_size(path, sum(8 * prod(shape) for _, shape, _ in whosmat(path, appendmat=False)))
        content = loadmat(path, appendmat=False, simplify_cells=True)
    except NotImplementedError:
        raise ParameterError(f"{path} is a file of MATLAB 7.3; save it with -v7") from None
    return _flat({name: content[name] for name in content if not name.startswith("__")})


def _flat(content: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """The arrays, those in structs by their fields: as STRUCT.FIELD if two have the same."""
    named = list(_arrays(content))
    alone = len({path[-1] for path, _ in named}) == len(named)
    return {path[-1] if alone else ".".join(path): values for path, values in named}


def _arrays(content: Mapping[str, Any]) -> Iterator[tuple[tuple[str, ...], np.ndarray]]:
    """The arrays, with the names of the structs that they are in."""
    for name, values in content.items():
        fields = values if isinstance(values, Mapping) else np.asarray(values).dtype.names
        if fields:
            for path, array in _arrays({field: values[field] for field in fields}):
                yield (name, *path), array
        else:
            yield (name,), np.atleast_1d(values)


def write_npz(path: Path, arrays: Columns) -> None:
    """Write arrays as numpy does; its 1.26 leaves the file open if the disk is full."""
    with ZipFile(path, "w", ZIP_DEFLATED) as archive:
        for name, values in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as file:
                np.lib.format.write_array(file, np.asarray(values), allow_pickle=False)


def _read_npz(path: Path) -> dict[str, np.ndarray]:
    try:
        with ZipFile(path) as file:
            _check_size(path, sum(each.file_size for each in file.infolist()))
    except BadZipFile:
        raise ParameterError(f"{path} is not an npz file") from None
    with np.load(path, allow_pickle=False) as content:
        return {name: content[name] for name in content.files}


def tabulated(path: Path, arrays: Columns) -> Table:
    """Arrays as columns: vectors of one length, and a matrix with as many names as columns."""
    table = Table(path, {}, {}, {})
    texts = [values for values in arrays.values() if values.dtype.kind in "OU"]
    for name, values in _flat(arrays).items():
        vector = values.reshape(-1) if values.ndim < 2 or 1 in values.shape else values
        names = next((text for text in texts if text.shape == vector.shape[1:]), None)
        if not _is_numeric(vector):
            continue
        if vector.ndim == 1:
            table.columns[name] = vector.astype(float)
        elif names is not None and vector.ndim == 2:
            table.columns.update(
                zip(map(str.strip, map(str, names)), vector.T.astype(float), strict=True)
            )
        else:
            size = " x ".join(map(str, values.shape))
            table.problems[name] = f"{name} is a matrix ({size}) without names of its columns"
    return _of_one_length(table)


def _of_one_length(table: Table) -> Table:
    """The table without single numbers; series of another length than most are problems."""
    columns = {name: values for name, values in table.columns.items() if len(values) > 1}
    rows = Counter(map(len, columns.values())).most_common(1)
    for name, values in list(columns.items()):
        if len(values) != rows[0][0]:
            table.problems[name] = f"{name} has {len(values)} values, others have {rows[0][0]}"
            columns[name] = np.full(rows[0][0], np.nan)
    return table._replace(columns=columns)


def _check_size(path: Path, size: int) -> None:
    if size > LARGEST_CONTENT:
        raise ParameterError(f"{path} holds {size} bytes, at most {LARGEST_CONTENT} are read")


def _is_numeric(values: np.ndarray) -> bool:
    return values.dtype.kind in "fiub"


_FORMATS: dict[str, tuple[Callable[[Path, Columns], None], Callable[[Path], Any]]] = {
    ".csv": (_write_csv, read_csv),
    ".parquet": (_write_parquet, _read_parquet),
    ".mat": (_write_matlab, _read_matlab),
    ".npz": (write_npz, _read_npz),
}
