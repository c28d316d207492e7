"""Ends a process when it is told to; needs no ROS."""

import signal
from types import FrameType

from furuta_ros.process_start import set_interrupt_handler


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
