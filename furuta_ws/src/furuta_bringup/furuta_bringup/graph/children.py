"""The processes of the nodes: started together, ended together, with the reason of a failure."""

import signal
import subprocess
from collections.abc import Sequence
from typing import Any

from furuta_ros.process import INTERRUPTED, child_environment

# Time for a process to end after SIGTERM [s].
END_TIMEOUT = 5.0
# Return codes of a node that was told to end, also before it was ready.
ENDED = {0, INTERRUPTED, 128 + signal.SIGTERM, -signal.SIGINT, -signal.SIGTERM}


def wait_or_kill(child: subprocess.Popen[Any]) -> bool:
    """Wait until a process that was told to end has ended; True if it had to be killed.

    The middleware can wait for itself for ever when it ends.
    """
    try:
        child.wait(END_TIMEOUT)
    except subprocess.TimeoutExpired:
        child.kill()
        child.wait()
        return True
    return False


class Children:
    """Child processes by the name of their node. They end with this process, whatever ends it."""

    def __init__(self) -> None:
        self._by_name: dict[str, subprocess.Popen[bytes]] = {}
        self._by_itself: list[str] = []  # nodes that ended without being told to
        self._killed: list[str] = []  # nodes that did not end when they were told to

    def start(self, name: str, command: Sequence[str]) -> None:
        """Start the process of a node."""
        self._by_name[name] = subprocess.Popen(command, env=child_environment())

    def any_has_ended(self) -> bool:
        """Whether a process has ended without being told to."""
        ended = (name for name, child in self._by_name.items() if child.poll() is not None)
        self._by_itself = list(ended)
        return bool(self._by_itself)

    def end(self) -> None:
        """End all processes, and wait until they have ended."""
        for child in self._by_name.values():
            child.terminate()
        self._killed = [name for name, child in self._by_name.items() if wait_or_kill(child)]

    def failures(self, stopped: bool) -> dict[str, int]:
        """Exit status by node for those that failed; the first one is the cause.

        ``stopped`` says that a signal to stop was received: then a node may end by itself too.
        """
        first = [] if stopped else self._by_itself
        codes = {name: child.returncode for name, child in self._by_name.items()}
        causes = {name: codes[name] for name in first if codes[name] != 0}
        others = {name: code for name, code in codes.items() if code not in ENDED}
        return {name: _status(code) for name, code in (causes | others).items()}

    @property
    def all_were_ready(self) -> bool:
        """Whether no node was told to end before it was ready."""
        return all(child.returncode == 0 for child in self._by_name.values())

    def describe_end(self, name: str) -> str:
        """How a node has ended, in one line."""
        code = self._by_name[name].returncode
        if name in self._killed:
            return f"{name} did not end within {END_TIMEOUT:g} s and was killed"
        if code < 0:
            return f"{name} was ended by {signal.Signals(-code).name}"
        return f"{name} failed with status {code}"


def _status(code: int) -> int:
    """The exit status that a shell shows for a return code."""
    return code if code >= 0 else 128 - code
