"""Errors of rigs, drivers and commissioning."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


class RigError(RuntimeError):
    """Base class of all errors of a rig."""


class DriverError(RigError):
    """The rig driver cannot be loaded, or lacks what was asked for."""


class LineError(RigError):
    """The line to the rig cannot be opened, or it failed."""


class StoppedError(RigError):
    """The guard stopped an experiment."""


class NotStillError(RigError):
    """The zeros cannot be measured because something moves."""


@contextmanager
def line_errors() -> Iterator[None]:
    """Turn the system's errors, including those of pyserial, into :class:`LineError`."""
    try:
        yield
    except OSError as error:
        raise LineError(str(error)) from None
