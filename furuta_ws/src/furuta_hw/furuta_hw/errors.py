"""Errors of rigs, drivers and commissioning."""

import os
from collections.abc import Iterator
from contextlib import contextmanager


class RigError(RuntimeError):
    """A driver cannot be loaded, or an experiment on the rig cannot go on."""


class LineError(RigError):
    """The line to the rig cannot be opened, or it failed."""


@contextmanager
def line_errors(what: str = "the line failed") -> Iterator[None]:
    """Turn the system's errors and those of pyserial into :class:`LineError`, after ``what``."""
    try:
        yield
    except (OSError, TypeError, ValueError) as error:
        # The system's message: that of pyserial repeats the port.
        number = getattr(error, "errno", None)
        raise LineError(f"{what}: {os.strerror(number) if number else error}") from None
