"""A line on the terminal that shows the motion while the graph runs in this process.

A thread of its own writes it: a terminal that is held with Ctrl-S must not hold up a sample. The
text is made by hand because a line of a table library takes a millisecond, a whole sample.
"""

import threading
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import pi
from typing import NamedTuple, TextIO

# Time between two readings of the state, and between two lines [s].
READ_PERIOD, LINES_EVERY = 0.05, 10
# Time over which the peak-to-peak value is measured [s].
MEASURED = 5.0
CLEAR = "\r\x1b[K"


class Status(NamedTuple):
    """What the line shows: angles [rad], and counts of late samples where they are counted."""

    arm: float
    pendulum: float
    late: int | None = None
    samples: int = 0


@contextmanager
def status_line(read: Callable[[], Status], encoder_counts: int, stream: TextIO) -> Iterator[None]:
    """Show the line on a terminal inside the ``with`` block; elsewhere nothing is written."""
    if not stream.isatty():
        yield
        return
    ended = threading.Event()
    thread = threading.Thread(target=_write, args=(read, encoder_counts, stream, ended))
    thread.daemon = True  # a terminal that is held does not keep the process from ending
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join(1.0)


def _write(
    read: Callable[[], Status], encoder_counts: int, stream: TextIO, ended: threading.Event
) -> None:
    angles: deque[float] = deque(maxlen=round(MEASURED / READ_PERIOD))
    readings = 0
    while not ended.wait(READ_PERIOD):
        status = read()
        angles.append(status.arm)
        readings += 1
        if readings % LINES_EVERY == 0:
            stream.write(CLEAR + describe(status, max(angles) - min(angles), encoder_counts))
            stream.flush()
    stream.write(CLEAR)
    stream.flush()


def describe(status: Status, peak_to_peak: float, encoder_counts: int) -> str:
    """The line; ``peak_to_peak`` [rad] is that of the arm."""
    counts = peak_to_peak * encoder_counts / (2 * pi)
    residual = f" = {counts:.1f} counts" if encoder_counts else ""
    late = "" if status.late is None else f"   late {status.late} of {status.samples}"
    return (
        f"arm {status.arm:+.3f} rad   pendulum {status.pendulum:+.4f} rad   "
        f"arm peak to peak {peak_to_peak:.3f} rad{residual}{late}"
    )
