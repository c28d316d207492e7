"""Drives the page in a browser for measurements, by commands on standard input.

Each command is answered by one line, mostly a time of ``time.time()`` [s]:

    open ADDRESS     when the curve of the arm has changed
    press LABEL      when the right arrow key was pressed on the slider with this label
    close            when the page is closed

Where root starts it, Chromium gives its drawing process niceness -8, before the loop that is
measured. A user's browser cannot do that, so this one gives up the right to do it.
"""

import ctypes
import sys
from time import time
from typing import Any

from browser import Page, open_browser

ARM = "arm φ [rad]"
POLL = 5.0  # [ms]
# prctl(2) and capabilities(7): programs started from now on may not raise their priority.
PR_CAPBSET_DROP, CAP_SYS_NICE = 24, 23


class Driver:
    """Answers commands; ``show`` opens a page."""

    def __init__(self, show: Any) -> None:
        self._show = show
        self._page: Page | None = None

    def answer(self, command: str, *arguments: str) -> float:
        """Do what a command says."""
        answer: float = getattr(self, command)(*arguments)
        return answer

    def open(self, address: str) -> float:
        """Show the page of a graph."""
        self._page = self._show(address)
        self.page.wait(lambda: self.page.curve(ARM), "a curve")
        before = self.page.curve(ARM)
        while self.page.curve(ARM) == before:
            self.page.page.wait_for_timeout(POLL)
        return time()

    def close(self) -> float:
        """Close the page."""
        self.page.page.close()
        return time()

    def press(self, label: str) -> float:
        """Move a slider by a step."""
        slider = self.page.row(label).get_by_role("slider").first
        slider.focus()
        start = time()
        slider.press("ArrowRight")
        return start

    @property
    def page(self) -> Page:
        """The open page."""
        assert self._page is not None, "no page is open"
        return self._page


if __name__ == "__main__":
    ctypes.CDLL(None).prctl(PR_CAPBSET_DROP, CAP_SYS_NICE, 0, 0, 0)  # refused unless root
    with open_browser() as show:
        driver = Driver(show)
        print("ready", flush=True)
        for line in sys.stdin:
            print(driver.answer(*line.rstrip("\n").split("\t")), flush=True)
