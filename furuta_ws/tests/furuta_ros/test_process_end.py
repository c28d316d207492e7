"""How a process ends: both signals at once."""

import subprocess
import sys

BOTH_SIGNALS = """
import os, signal
from furuta_ros.stop_signal import StopSignal

both = (signal.SIGINT, signal.SIGTERM)
stop = StopSignal()
signal.pthread_sigmask(signal.SIG_BLOCK, both)
for number in both:
    os.kill(os.getpid(), number)
signal.pthread_sigmask(signal.SIG_UNBLOCK, both)
assert (stop(), stop.status) == (True, 130)
for number in both:
    os.kill(os.getpid(), number)
"""
TIMEOUT = 60.0


def test_both_signals_at_once_print_nothing() -> None:
    """Python would print an error if a handler ignored a signal that has been received too."""
    done = subprocess.run(
        [sys.executable, "-c", BOTH_SIGNALS], capture_output=True, timeout=TIMEOUT, check=False
    )
    assert (done.returncode, done.stderr) == (0, b"")
