"""The line on the terminal while the graph runs."""

import os
import pty
import threading
from io import StringIO
from math import pi

from furuta_graph.status_line import Status, describe, status_line


def test_line_names_angles_and_what_is_left_in_counts() -> None:
    """A twentieth of a turn is five of a hundred counts."""
    line = describe(Status(0.1, -0.02, 3, 1000), 2 * pi / 20, 100)
    assert "arm +0.100 rad" in line
    assert "pendulum -0.0200 rad" in line
    assert "= 5.0 counts" in line
    assert "late 3 of 1000" in line


def test_nothing_is_written_where_there_is_no_terminal() -> None:
    """Output into a file or a pipe stays as it was."""
    stream = StringIO()
    with status_line(lambda: Status(0.0, 0.0), 250, stream):
        pass
    assert stream.getvalue() == ""


def test_terminal_shows_the_line() -> None:
    """Read at the other end of a pseudo-terminal."""
    master, slave = pty.openpty()
    with os.fdopen(slave, "w") as terminal, status_line(lambda: Status(0.25, 0.01), 250, terminal):
        shown = b""
        while b"arm +0.250 rad" not in shown:
            shown += os.read(master, 4096)
    os.close(master)


class HeldTerminal(StringIO):
    """A terminal that takes nothing, as after Ctrl-S."""

    def __init__(self) -> None:
        super().__init__()
        self.asked, self.goes_on = threading.Event(), threading.Event()

    def isatty(self) -> bool:
        """It is a terminal."""
        return True

    def write(self, text: str) -> int:
        """Wait until the terminal goes on."""
        self.asked.set()
        self.goes_on.wait()
        return len(text)


def test_held_terminal_holds_up_nothing() -> None:
    """The block goes on, and ends, while the line waits."""
    terminal = HeldTerminal()
    with status_line(lambda: Status(0.0, 0.0), 250, terminal):
        assert terminal.asked.wait(60.0)
    assert not terminal.goes_on.is_set()
    terminal.goes_on.set()
