"""Runs a graph and its page as two processes, so that neither disturbs the other."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from time import sleep

from furuta_graph.children import END_TIMEOUT, Children
from furuta_graph.processes import CHECK_PERIOD, executable
from furuta_model.process_start import child_environment
from furuta_ros.spinning import StopSignal

GRAPH, PAGE = "graph", "page"


def run_with_page(graph: Sequence[str], page: Sequence[str]) -> int:
    """Run ``furuta run`` with the arguments ``graph`` and ``furuta view`` with ``page``.

    Until Ctrl-C or until the graph ends; returns the exit status. If the page ends, the graph runs
    on: it may hold a pendulum upright.
    """
    stop = StopSignal()
    shown = _start_page([str(executable("furuta_bringup", "furuta")), "view", *page])
    if shown is None:
        return 1
    graph_process = Children()
    try:
        graph_process.start(GRAPH, [str(executable("furuta_bringup", "graph")), *graph])
        _watch(graph_process, shown, stop)
    finally:
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


def _watch(graph: Children, page: subprocess.Popen[str], stop: StopSignal) -> None:
    told = False
    while not (stop() or graph.any_has_ended()):
        if page.poll() is not None and not told:
            told = True
            print(
                f"error: the page has ended with status {page.returncode}; the graph runs on "
                "(furuta view --attach shows it again)",
                file=sys.stderr,
            )
        sleep(CHECK_PERIOD)


def _end(page: subprocess.Popen[str]) -> None:
    page.terminate()
    try:
        page.wait(END_TIMEOUT)
    except subprocess.TimeoutExpired:
        page.kill()
        page.wait()
