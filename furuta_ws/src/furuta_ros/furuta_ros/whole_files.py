"""Files that are there whole or not at all."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from furuta_ros.errors import UserError

# Where verbs write by default.
OUTPUT = Path("output")


def make_directory(path: Path) -> None:
    """Make a directory with its parents.

    Except for the usual :data:`OUTPUT` a line on standard error says so: it may be a slip.
    """
    if not path.is_dir():
        path.mkdir(parents=True, exist_ok=True)
        whole = path.resolve()
        if OUTPUT.resolve() not in (whole, *whole.parents):
            print(f"note: made the directory {path}", file=sys.stderr)


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A path to write to; at the end of the ``with`` block what is there becomes ``path``.

    After an error nothing is there, and an earlier file is left as it was. The directory is
    made (:func:`make_directory`). A device or pipe is written to directly.

    Raises:
        UserError: The file cannot be written, for example because the disk is full.
    """
    target = path.resolve()
    new = target.with_name(f".{target.stem}.new{target.suffix}")
    try:
        make_directory(target.parent)
        if target.exists() and not target.is_file():
            yield target
            return
        yield new
        new.replace(target)
    except OSError as error:
        raise UserError(f"cannot write {path}: {error.strerror or error}") from None
    finally:
        with suppress(OSError):
            new.unlink()
