"""What the notebooks of the lab course share: check cells, and processes that end by themselves."""

import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Thread
from time import monotonic, sleep
from traceback import walk_tb
from typing import Any

from IPython import get_ipython

# How long a process may take to end after SIGINT, and a verb to finish [s].
GRACE = 20.0
TIMEOUT = 300.0


class NotYetError(Exception):
    """An answer that is not right yet; Jupyter shows the hint without a traceback."""

    def _render_traceback_(self) -> list[str]:
        return [f"Not yet: {self}"]


def check(claim: str, holds: Any, hint: str) -> None:
    """Print the claim if it holds.

    Raises:
        NotYetError: It does not hold; the message is the hint.
    """
    if not bool(holds):
        raise NotYetError(hint)
    print(f"Right: {claim}.")


def need(answer: Any) -> None:
    """Ask for an answer that a check needs.

    Raises:
        NotYetError: There is none: it is None.
    """
    if answer is None:
        raise NotYetError("there is no answer yet")


def _explain(shell: Any, kind: type, error: Any, trace: Any, tb_offset: int | None = None) -> None:
    """Say which name a cell lacks because one above has no answer; show other errors whole."""
    *_, (frame, _) = walk_tb(trace)
    if frame.f_code.co_name == "<module>":
        print(f"Not yet: {error.name} comes from a cell above that has not run to its end.")
    else:
        shell.showtraceback((kind, error, trace), tb_offset=tb_offset)


def _prepare_notebook() -> None:
    """In Jupyter, explain missing names; what goes to standard error is no error, so not red."""
    shell = get_ipython()
    if shell is not None:
        shell.set_custom_exc((NameError,), _explain)
        sys.stderr = sys.stdout


def furuta(*arguments: Any) -> Any:
    """Run a verb of the command line to its end.

    Returns:
        What it prints; with ``--json`` among the arguments a dictionary.

    Raises:
        RuntimeError: The verb failed; the message is its one line of error.
    """
    given = list(map(str, arguments))
    done = subprocess.run(
        [_command(), *given],
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
        check=False,
        env=_environment(),
    )
    if done.returncode:
        raise RuntimeError(done.stderr.strip() or f"furuta ended with status {done.returncode}")
    return json.loads(done.stdout) if "--json" in given else done.stdout.strip()


class Running:
    """A process of the command line, and the lines that it has printed so far."""

    def __init__(self, arguments: tuple[Any, ...]) -> None:
        self.printed: list[str] = []
        self._process = subprocess.Popen(
            [_command(), *map(str, arguments)],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env=_environment(),
        )
        self._reader = Thread(target=self._read, daemon=True)
        self._reader.start()

    def wait_for(self, text: str, seconds: float = 60.0) -> None:
        """Wait until it has printed this text.

        Raises:
            RuntimeError: It ended before, or the time is over; the message is what it printed.
        """
        end = monotonic() + seconds
        while not any(text in line for line in self.printed):
            if self._process.poll() is not None or monotonic() > end:
                raise RuntimeError(f"'{text}' did not come, only: {' '.join(self.printed)}")
            sleep(0.05)

    def end(self) -> None:
        """End it as Ctrl-C does; kill it if it does not end."""
        if self._process.poll() is None:
            self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(GRACE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._reader.join()

    def _read(self) -> None:
        assert self._process.stdout is not None
        with self._process.stdout as lines:
            for line in lines:
                self.printed.append(line.rstrip())


@contextmanager
def running(*arguments: Any) -> Iterator[Running]:
    """Start a verb of the command line, and end it at the end of the ``with`` block."""
    process = Running(arguments)
    try:
        yield process
    finally:
        process.end()


def _environment() -> dict[str, str]:
    """Without Jupyter's request for colours, which would stand among the text."""
    colours = ("FORCE_COLOR", "CLICOLOR_FORCE")
    return {name: value for name, value in os.environ.items() if name not in colours}


def _command() -> str:
    command = shutil.which("furuta")
    if command is None:
        raise RuntimeError("no command furuta on the path; start Jupyter by make course")
    return command


_prepare_notebook()
