"""Files that are there whole or not at all."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from furuta_ros.errors import UserError


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A path to write to; at the end of the ``with`` block what is there becomes ``path``.

    After an error nothing is there, and an earlier file is left as it was. The directory is
    created. A device or pipe is written to directly.

    Raises:
        UserError: The file cannot be written, for example because the disk is full.
    """
    target = path.resolve()
    new = target.with_name(f".{target.stem}.new{target.suffix}")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
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
