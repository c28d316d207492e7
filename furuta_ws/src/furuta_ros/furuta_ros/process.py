"""Start and end of a process: its arguments, its end by a signal or with its parent. Needs no ROS.

An executable starts with SIGINT blocked (see its ``setup.py``), because Python itself answers it
with a traceback as soon as it runs. The signal waits until :func:`exit_on_interrupt`.
"""

import ctypes
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from types import FrameType

from furuta_ros.errors import UserError

# Exit status of a process that Ctrl-C has ended: 128 + SIGINT.
INTERRUPTED = 128 + signal.SIGINT

STDERR = 2
# Ends the line with ^C, and shows the cursor again that a progress bar hides.
AFTER_INTERRUPT = b"\n\x1b[?25hinterrupted\n"
# Environment variable in which a parent gives its process id to a child that is to end with it.
PARENT = "FURUTA_PARENT"
# Of prctl(2): the signal that a process receives when its parent ends.
PR_SET_PDEATHSIG = 1
# The command-line arguments that ROS was started with in this process.
ROS_ARGUMENTS: list[str] = []
# Longest time [s] that the middleware gets for its end: less than who ends a node waits for it.
LONGEST_END = 3
# Of time.h and signal.h: a clock, and how a timer notifies.
CLOCK_MONOTONIC, SIGEV_THREAD = 1, 2


def run_entry(entry: str) -> None:
    """Import ``module:function`` and call it; Ctrl-C during the import ends the process."""
    exit_on_interrupt()
    end_with_parent()
    module, _, function = entry.partition(":")
    try:
        run = getattr(import_module(module), function)
    except UserError as error:  # ROS is too old
        sys.exit(f"error: {error}")
    run()


def exit_on_interrupt() -> None:
    """Let Ctrl-C end the process at once, with status 130.

    KeyboardInterrupt can arrive in a library that prints a traceback, forgets it or crashes. All
    files are written so that a kill does no harm. What must clean up uses
    :func:`interrupt_raised`.
    """
    set_interrupt_handler(_exit)


@contextmanager
def interrupt_raised() -> Iterator[None]:
    """Inside the ``with`` block Ctrl-C raises KeyboardInterrupt, so that a rig is left at 0 V."""
    set_interrupt_handler(signal.default_int_handler)
    try:
        yield
    finally:
        exit_on_interrupt()


def set_interrupt_handler(handler: Callable[[int, FrameType | None], object]) -> None:
    """Set the handler of SIGINT, and let the signal through if it was blocked at the start."""
    signal.signal(signal.SIGINT, handler)
    if hasattr(signal, "pthread_sigmask"):  # Windows has none, and blocks no signal
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])


def _exit(number: int, frame: FrameType | None) -> None:
    if os.isatty(STDERR):
        os.write(STDERR, AFTER_INTERRUPT)
    os._exit(INTERRUPTED)


def own_arguments(arguments: Sequence[str]) -> list[str]:
    """The arguments without those for ROS: from ``--ros-args`` to ``--`` or to the end."""
    own, for_ros = [], False
    for argument in arguments:
        if argument == "--ros-args":
            for_ros = True
        elif for_ros:
            for_ros = argument != "--"
        else:
            own.append(argument)
    return own


def child_environment() -> dict[str, str]:
    """The environment of a child process that is to end when this process ends."""
    return os.environ | {PARENT: str(os.getpid())}


def end_with_parent() -> None:
    """Let this process receive SIGTERM when its parent ends, if the parent has asked for it.

    It does so whatever ends the parent, SIGKILL included.
    """
    parent = os.environ.pop(PARENT, None)
    if parent is None:
        return
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    if os.getppid() != int(parent):  # it has ended before
        os._exit(128 + signal.SIGTERM)


class StopSignal:
    """Becomes true when the process receives SIGINT or SIGTERM; it then ignores further ones.

    Otherwise one that arrives while Python ends would kill the process. While it is ``at_once``, a
    signal ends the process without more: a start can take longer than who ends a node waits.
    """

    def __init__(self, at_once: bool = False) -> None:
        self._received, self.at_once = 0, at_once
        set_interrupt_handler(self._receive)
        signal.signal(signal.SIGTERM, self._receive)

    def _receive(self, number: int, frame: FrameType | None) -> None:
        self._received = self._received or number
        if self.at_once:
            os._exit(self.status)

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
