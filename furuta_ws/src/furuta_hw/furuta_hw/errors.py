"""Errors of rigs, drivers and commissioning."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from furuta_ros.errors import described


class RigError(RuntimeError):
    """A driver cannot be loaded, or an experiment on the rig cannot go on."""


class LineError(RigError):
    """The line to the rig cannot be opened, or it failed."""


@contextmanager
def line_errors(what: str = "the line failed", remedy: Callable[[], str] = str) -> Iterator[None]:
    """Turn the system's errors and those of pyserial into :class:`LineError`, after ``what``.

    ``remedy`` gives the end of the message.
    """
    try:
        yield
    except (OSError, TypeError, ValueError) as error:
        # The system's message: that of pyserial repeats the port.
        number = getattr(error, "errno", None)
        reason = os.strerror(number) if number else error
        raise LineError(f"{what}: {reason}{remedy()}") from None


@contextmanager
def driver_errors() -> Iterator[None]:
    """Turn an exception that nobody expects of a driver into :class:`LineError`, with its place."""
    try:
        yield
    except RigError:
        raise
    except Exception as error:
        raise LineError(f"the line to the rig: {described(error)}") from None
