"""Errors of rigs, drivers and commissioning."""

from collections.abc import Iterator
from contextlib import contextmanager


class RigError(RuntimeError):
    """A driver cannot be loaded, or an experiment on the rig cannot go on."""


class LineError(RigError):
    """The line to the rig cannot be opened, or it failed."""


@contextmanager
def line_errors() -> Iterator[None]:
    """Turn the system's errors, including those of pyserial, into :class:`LineError`."""
    try:
        yield
    except OSError as error:
        raise LineError(str(error)) from None
