"""Runs a graph and its page as two processes, so that neither disturbs the other."""

import subprocess
import sys
from collections.abc import Sequence
from time import sleep

from furuta_graph.children import Children, wait_or_kill
from furuta_graph.processes import CHECK_PERIOD, executable
from furuta_graph.settings.nodes import PLANT
from furuta_ros.process_end import StopSignal
from furuta_ros.process_start import child_environment
from furuta_view.simulation_controls import FOREVER


def run_with_page(graph: Sequence[str], page: Sequence[str], shared: Sequence[str]) -> int:
    """Run ``furuta run`` with the arguments ``graph`` and ``furuta view`` with ``page``.

    Both and ``furuta param`` take ``shared``. Until Ctrl-C or until the graph ends; returns the
    exit status. If the page ends, the graph runs on: it may hold a pendulum upright. A plant in
    lock-step that the page has paused continues.
    """
    stop = StopSignal()
    furuta = str(executable("furuta_bringup", "furuta"))
    shown = _start_page([furuta, "view", *page, *shared])
    if shown is None:
        return 1
    children = Children()
    try:
        children.start("graph", [furuta, "run", *shared, *graph])
        while not (is_over := stop() or children.any_has_ended()) and shown.poll() is None:
            sleep(CHECK_PERIOD)
        if not is_over:
            _report_end(shown.returncode)
            if "--lockstep" in graph:
                release = [furuta, "param", "set", *shared, PLANT, "run_until", str(FOREVER)]
                subprocess.Popen(release, env=child_environment())
        while not (stop() or children.any_has_ended()):
            sleep(CHECK_PERIOD)
    finally:
        children.end()
        shown.terminate()
        wait_or_kill(shown)
    return next(iter(children.failures(stop()).values()), 0)


def _start_page(command: list[str]) -> subprocess.Popen[str] | None:
    """Start the page and print its address; None if it has failed, with its reason printed."""
    started = subprocess.Popen(command, env=child_environment(), stdout=subprocess.PIPE, text=True)
    assert started.stdout is not None
    address = started.stdout.readline()
    if not address:
        started.wait()
        return None
    print(address, end="", flush=True)
    return started


def _report_end(status: int) -> None:
    print(
        f"error: the page has ended with status {status}; the graph runs on "
        "(furuta view --attach shows it again)",
        file=sys.stderr,
    )
