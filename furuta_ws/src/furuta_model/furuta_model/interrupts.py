"""Turns Ctrl-C into KeyboardInterrupt while a command runs, so that it can clean up."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Timer, main_thread
from typing import Any

from furuta_model.process_start import exit_on_interrupt, set_interrupt_handler

# Time after which an interrupt is repeated that could not be raised where it arrived [s].
REPEAT_AFTER = 0.01


@contextmanager
def interrupts_raised() -> Iterator[None]:
    """Inside the ``with`` block Ctrl-C raises KeyboardInterrupt; after it, it ends the process."""
    earlier = sys.unraisablehook
    sys.unraisablehook = _repeat_interrupt
    set_interrupt_handler(signal.default_int_handler)
    try:
        yield
    finally:
        exit_on_interrupt()
        sys.unraisablehook = earlier


def _repeat_interrupt(unraisable: Any) -> None:
    """Raise an interrupt again a little later if it arrived where none can be raised.

    Python would print a traceback and forget it, for example in a destructor.
    """
    if not isinstance(unraisable.exc_value, KeyboardInterrupt):
        sys.__unraisablehook__(unraisable)
        return
    main = main_thread().ident
    assert main is not None
    timer = Timer(REPEAT_AFTER, signal.pthread_kill, (main, signal.SIGINT))
    timer.daemon = True
    timer.start()
