"""How a process ends: both signals at once, and a middleware that waits for itself for ever."""

import os
import signal
import subprocess
import sys

import pytest

from furuta_ros.process_end import bounded_end

BOTH_SIGNALS = """
import os, signal
from furuta_ros.process_end import StopSignal

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
# PyDLL keeps Python's lock during the call, as rclpy does.
BLOCKED_NODE = """
import ctypes, sys
from typing import NamedTuple
from furuta_ros.node import FurutaNode
from furuta_ros.spinning import run_node

class NoParameters(NamedTuple):
    pass

class BlockedNode(FurutaNode[NoParameters]):
    runs_compiled_code = False

    def __init__(self):
        super().__init__("blocked", NoParameters)

    def destroy_node(self):
        print("blocks", flush=True)
        ctypes.PyDLL(None).pause()

print("kept")
sys.exit(run_node(BlockedNode))
"""
TIMEOUT = 60.0


def test_both_signals_at_once_print_nothing() -> None:
    """Python would print an error if a handler ignored a signal that has been received too."""
    done = subprocess.run(
        [sys.executable, "-c", BOTH_SIGNALS], capture_output=True, timeout=TIMEOUT, check=False
    )
    assert (done.returncode, done.stderr) == (0, b"")


def test_a_node_ends_though_the_middleware_does_not() -> None:
    """With status 0, and with what it has printed."""
    node = subprocess.Popen(
        [sys.executable, "-c", BLOCKED_NODE],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        assert node.stderr is not None
        while "ready" not in (line := node.stderr.readline()):
            assert line
        node.send_signal(signal.SIGTERM)
        out, err = node.communicate(timeout=TIMEOUT)
    finally:
        node.kill()
    assert (node.returncode, out, err) == (0, "kept\nblocks\n", "")


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
