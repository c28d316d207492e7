"""Ends a process in a bounded time, also when the middleware waits for itself for ever."""

import ctypes
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

# Longest time [s] that the middleware gets for its end: less than who ends a node waits for it.
LONGEST_END = 3
# Of time.h and signal.h: a clock, and how a timer notifies.
CLOCK_MONOTONIC, SIGEV_THREAD = 1, 2


class _Event(ctypes.Structure):
    """What a timer does: calls ``function`` with ``value`` (struct sigevent)."""

    _fields_ = (
        ("value", ctypes.c_void_p),
        ("signal", ctypes.c_int),
        ("notify", ctypes.c_int),
        ("function", ctypes.c_void_p),
        ("unused", ctypes.c_void_p * 5),
    )


@contextmanager
def bounded_end(status: int) -> Iterator[None]:
    """End the process with ``status`` if the ``with`` block takes longer than ``LONGEST_END``.

    The block destroys nodes, after all else is closed. rclpy holds Python's lock meanwhile, so that
    no handler and no thread of Python runs. A timer of the C library calls its ``_exit`` instead.
    """
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError):  # nobody reads it any more
            stream.flush()  # _exit does not
    libc, timer = ctypes.CDLL(None), ctypes.c_void_p()
    ends = ctypes.cast(libc._exit, ctypes.c_void_p).value
    event = _Event(value=status, notify=SIGEV_THREAD, function=ends)
    libc.timer_create(CLOCK_MONOTONIC, ctypes.byref(event), ctypes.byref(timer))
    times = (ctypes.c_long * 4)(0, 0, LONGEST_END, 0)  # not repeated; s and ns
    libc.timer_settime(timer, 0, ctypes.byref(times), None)
    try:
        yield
    finally:
        libc.timer_delete(timer)
