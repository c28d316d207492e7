"""Opens files that a user or another file names: regular files of a bounded size only.

A device has no end, and reading a named pipe waits for somebody to write into it.
"""

import os
import stat
from pathlib import Path
from typing import BinaryIO

from furuta_model.parameters import ParameterError


def open_regular(file: Path, what: str) -> BinaryIO:
    """Open a regular file for reading; ``what`` names it in the error, such as ``rig file``.

    Raises:
        ParameterError: There is no such file, it cannot be read, or it is not a regular file.
    """
    try:
        # Without O_NONBLOCK opening a named pipe would wait.
        descriptor = os.open(file, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ParameterError(f"cannot read {what} {file}: {reason}") from None
    mode = os.fstat(descriptor).st_mode
    if not stat.S_ISREG(mode):
        os.close(descriptor)
        kind = "a directory" if stat.S_ISDIR(mode) else "a device or pipe"
        raise ParameterError(f"cannot read {what} {file}: it is {kind}, not a regular file")
    return os.fdopen(descriptor, "rb")


def read_text(file: Path, what: str, largest: int) -> str:
    """The text of a regular file of at most ``largest`` [bytes]."""
    with open_regular(file, what) as stream:
        data = stream.read(largest + 1)
    if len(data) > largest:
        raise ParameterError(
            f"cannot read {what} {file}: larger than {largest} bytes, the most allowed"
        )
    try:
        return data.decode()
    except UnicodeDecodeError:
        raise ParameterError(f"cannot read {what} {file}: not a text file") from None
