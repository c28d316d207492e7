"""What the notebooks of the lab course share: check cells, and processes that end by themselves."""

import json
import linecache
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from threading import Thread
from time import monotonic, sleep
from traceback import walk_tb
from typing import Any

import numpy as np
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


def need(answer: Any, form: Any = ()) -> Any:
    """The answer that a check needs, if it has the right form.

    ``form`` is the shape of an array, () for one number, a set of the names in a dictionary, a
    type, or a list of forms of several results.

    Raises:
        NotYetError: There is no answer, or one of another form.
    """
    if answer is None:
        raise NotYetError("there is no answer yet; a function must return one")
    if not _has(answer, form):
        raise NotYetError(f"the answer must be {_words(form)}, not {_given(answer)}")
    return answer


def _has(answer: Any, form: Any) -> bool:
    if isinstance(form, list):
        several = isinstance(answer, tuple | list | np.ndarray) and len(answer) == len(form)
        return several and all(map(_has, answer, form))
    if isinstance(form, set):
        named = isinstance(answer, dict) and form <= {*answer}
        return named and all(_has(answer[name], ()) for name in form)
    if isinstance(form, type):
        return isinstance(answer, form)
    try:
        numbers = np.asarray(answer)
    except ValueError:  # rows of different lengths
        return False
    return numbers.dtype.kind in "iufc" and numbers.shape == form


def _words(form: Any) -> str:
    """A form in words."""
    if isinstance(form, list):
        return " and ".join(map(_words, form))
    if isinstance(form, set):
        return f"a dictionary with the numbers {', '.join(sorted(form))}"
    if isinstance(form, type):
        return f"a {form.__name__}"
    if not form:
        return "one number"
    size = " × ".join(map(str, form))
    return f"{size} numbers"


def _given(answer: Any) -> str:
    """What was given instead, in words."""
    if isinstance(answer, str):
        return f"the text {answer!r}"[:80]
    if isinstance(answer, dict):
        return f"a dictionary with {', '.join(map(str, answer)) or 'nothing'}"[:80]
    try:
        numbers = np.asarray(answer)
    except ValueError:
        return "rows of different lengths"
    if numbers.dtype.kind in "iufc":
        return f"{_words(numbers.shape)}{'' if numbers.ndim else f', {answer}'}"
    return f"a {type(answer).__name__}"


# How an answer may be wrong, by its ratio to the right one.
RATIOS = {
    -1.0: "the negative of what is right",
    0.5: "half of what is right",
    2.0: "twice what is right",
    2.0 * np.pi: "2π times what is right",
    0.5 / np.pi: "what is right, divided by 2π",
    180.0 / np.pi: "in degrees instead of radians",
    np.pi / 180.0: "in radians instead of degrees",
    1e3: "a thousand times what is right",
    1e-3: "a thousandth of what is right",
}


def compared(given: Any, right: Any, names: Sequence[str] = ()) -> str:
    """How an answer differs from the right one, for a hint; ``names`` are those of the numbers."""
    given, right = np.asarray(given), np.asarray(right)
    for ratio, words in RATIOS.items():
        if np.allclose(given, ratio * right, rtol=0.02, atol=1e-9 * np.max(np.abs(right))):
            return f"it is {words}"
    for changed, words in ((right.T, "transposed"), (np.conj(right), "the complex conjugate")):
        if changed.shape == given.shape and np.allclose(given, changed, rtol=0.01):
            return f"it is {words}"
    if not given.ndim:
        return f"it is {given:.4g}, but {right:.4g} is right"
    worst = np.unravel_index(int(np.argmax(np.abs(given - right))), given.shape)
    name = names[int(worst[0])] if names else f"number {', '.join(str(k + 1) for k in worst)}"
    return f"{name} is {given[worst]:.4g}, but {right[worst]:.4g} is right"


def explanation(error: BaseException, trace: Any) -> str | None:
    """The line that says why a cell ended with an error; None for an error in a student's function.

    A cell that checks calls what students wrote above: an answer of another kind, or a value that
    the library refuses, is no reason to show its code. A function is shown with its own errors.
    """
    if isinstance(error, NotYetError):
        return str(error)
    frames = list(walk_tb(trace))
    cell = next(frame for frame, _ in frames if frame.f_code.co_name == "<module>")
    frame, line = [each for each in frames if each[0].f_globals is cell.f_globals][-1]
    if isinstance(error, NameError) and frames[-1][0] is cell:
        return f"{error.name} comes from a cell above that has not run to its end"
    text = " ".join(str(error).split())[:200]
    if any(kind.__name__ == "ParameterError" for kind in type(error).__mro__):
        return text
    if frame.f_code.co_filename != cell.f_code.co_filename:
        return None
    source = linecache.getline(frame.f_code.co_filename, line).strip()
    return f"line {line}, {source or type(error).__name__}: {text}"


def _explain(shell: Any, kind: type, error: Any, trace: Any, tb_offset: int | None = None) -> None:
    """Say in one line what a cell lacks; show other errors whole."""
    line = explanation(error, trace)
    if line is None or isinstance(error, NotYetError):
        shell.showtraceback((kind, error, trace), tb_offset=tb_offset)
    else:
        print(f"Not yet: {line}")


def _prepare_notebook() -> None:
    """In Jupyter, explain errors; what goes to standard error is no error, so not red."""
    shell = get_ipython()
    if shell is not None:
        shell.set_custom_exc((Exception,), _explain)
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
