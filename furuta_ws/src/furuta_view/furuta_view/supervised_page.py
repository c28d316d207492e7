"""Runs a graph and its page as two processes, so that neither disturbs the other."""

import subprocess
import sys
from collections.abc import Callable, Sequence
from time import sleep

from furuta_graph.children import END_TIMEOUT, Children
from furuta_graph.processes import CHECK_PERIOD, executable
from furuta_ros.process_start import child_environment
from furuta_ros.spinning import StopSignal
from furuta_sim.settings.nodes import PLANT
from furuta_view.simulation_controls import FOREVER

GRAPH, RELEASE = "graph", "release"


def run_with_page(graph: Sequence[str], page: Sequence[str], shared: Sequence[str]) -> int:
    """Run ``furuta run`` with the arguments ``graph`` and ``furuta view`` with ``page``.

    Both and ``furuta param`` take ``shared``. Until Ctrl-C or until the graph ends; returns the
    exit status. If the page ends, the graph runs on: it may hold a pendulum upright. A plant in
    lock-step that the page has paused continues.
    """
    stop = StopSignal()
    furuta = str(executable("furuta_bringup", "furuta"))
    release = [furuta, "param", "set", *shared, PLANT, "run_until", str(FOREVER)]
    shown = _start_page([furuta, "view", *page, *shared])
    if shown is None:
        return 1
    graph_process, helper = Children(), Children()

    def page_ended() -> None:
        print(
            f"error: the page has ended with status {shown.returncode}; the graph runs on "
            "(furuta view --attach shows it again)",
            file=sys.stderr,
        )
        if "--lockstep" in graph:
            helper.start(RELEASE, release)

    try:
        graph_process.start(GRAPH, [furuta, "run", *shared, *graph])
        _watch(graph_process, shown, page_ended, stop)
    finally:
        helper.end()
        graph_process.end()
        _end(shown)
    failures = graph_process.failures(stop())
    return next(iter(failures.values()), 0)


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


def _watch(
    graph: Children,
    page: subprocess.Popen[str],
    page_ended: Callable[[], None],
    stop: StopSignal,
) -> None:
    """Return when the graph ends or ``stop()``; call ``page_ended`` once if the page ends."""
    was_told = False
    while not (stop() or graph.any_has_ended()):
        if page.poll() is not None and not was_told:
            was_told = True
            page_ended()
        sleep(CHECK_PERIOD)


def _end(page: subprocess.Popen[str]) -> None:
    page.terminate()
    try:
        page.wait(END_TIMEOUT)
    except subprocess.TimeoutExpired:
        page.kill()
        page.wait()
