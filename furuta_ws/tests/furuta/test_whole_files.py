"""Files are written whole or not at all, also when the disk is full."""

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from furuta.figures.figure import axes_for, save_figure
from furuta.studies.study_tables import write_runs
from furuta_recordings.table_files import write_columns
from furuta_ros.errors import UserError
from furuta_ros.whole_files import whole_file


@contextmanager
def full_disk(size: int = 1000) -> Iterator[None]:
    """No file becomes larger than ``size`` [bytes]."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.parametrize("name", ["table.npz", "runs.csv", "a.png"])
def test_a_full_disk_leaves_no_part(tmp_path: Path, name: str) -> None:
    """The error names the file; an earlier one stays as it was."""
    file = tmp_path / name
    file.write_text("earlier")
    with full_disk(), pytest.raises(UserError, match=f"cannot write .*{name}: "):
        if name == "runs.csv":
            write_runs(({"a": float(k)} for k in range(10_000)), file)
        elif name == "a.png":
            save_figure(lambda: axes_for(None)[1], file)
        else:
            write_columns(file, {"time": np.random.default_rng(1).random(10_000)})
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert file.read_text() == "earlier"


def test_a_link_stays_a_link_and_a_device_is_written_to(tmp_path: Path) -> None:
    """The file that a link names is replaced."""
    link, file = tmp_path / "link.txt", tmp_path / "file.txt"
    link.symlink_to(file)
    with whole_file(link) as new:
        new.write_text("text")
    assert (link.is_symlink(), file.read_text()) == (True, "text")
    with whole_file(Path("/dev/null")) as new:
        assert new == Path("/dev/null")
