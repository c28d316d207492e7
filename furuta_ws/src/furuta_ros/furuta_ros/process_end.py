"""Ends a process: when it is told to, and in a bounded time; needs no ROS."""

import ctypes
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType

from furuta_ros.process_start import set_interrupt_handler

# Longest time [s] that the middleware gets for its end: less than who ends a node waits for it.
LONGEST_END = 3
# Of time.h and signal.h: a clock, and how a timer notifies.
CLOCK_MONOTONIC, SIGEV_THREAD = 1, 2


class StopSignal:
    """Becomes true when the process receives SIGINT or SIGTERM; it then ignores further ones.

    Otherwise one that arrives while Python ends would kill the process.
    """

    def __init__(self) -> None:
        self._received = 0
        set_interrupt_handler(self._receive)
        signal.signal(signal.SIGTERM, self._receive)

    def _receive(self, number: int, frame: FrameType | None) -> None:
        self._received = self._received or number

    def __call__(self) -> bool:
        """Whether the process has received a signal to stop; for the main thread."""
        if self._received:
            # Not in the handler: Python prints an error if it finds the other signal, received
            # together with this one, ignored. Here signal.signal calls its handler first.
            for further in (signal.SIGINT, signal.SIGTERM):
                signal.signal(further, signal.SIG_IGN)
        return self._received != 0

    @property
    def status(self) -> int:
        """Exit status of a process that the signal has ended before it was ready."""
        return 128 + self._received


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

    The block destroys nodes, after all else is closed. Fast DDS 2.14 sometimes waits for itself for
    ever there (eProsima/Fast-DDS issue 6502). rclpy holds Python's lock meanwhile, so that no
    handler and no thread of Python runs. A timer of the C library calls its ``_exit`` instead.
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
