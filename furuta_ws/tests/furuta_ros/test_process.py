"""How a process ends: both signals at once, and a middleware that waits for itself for ever."""

import os
import subprocess
import sys

import pytest

from furuta_ros.process import bounded_end

BOTH_SIGNALS = """
import os, signal
from furuta_ros.process import StopSignal

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


def test_nodes_are_destroyed_though_nobody_reads_the_output(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    destroyed = False
    reading, writing = os.pipe()
    os.close(reading)
    with open(writing, "w") as stream:
        stream.write("unread")
        monkeypatch.setattr(sys, "stdout", stream)
        with bounded_end(0):
            destroyed = True
        monkeypatch.undo()
        os.dup2(os.open(os.devnull, os.O_WRONLY), writing)
    assert destroyed
