"""Runs the page over a running graph: the process behind ``furuta view``."""

import os
import webbrowser
from contextlib import closing
from pathlib import Path

from furuta_ros.context import ros_context, tell_graph
from furuta_ros.spinning import StopSignal
from furuta_view.bag_page import BagPage
from furuta_view.bag_samples import BagSamples
from furuta_view.live_page import LivePage
from furuta_view.server import PageServer


def run_bag_page(server: PageServer, bag: Path, opens: bool) -> None:
    """Show a recording until Ctrl-C."""
    stop = StopSignal()
    with closing(BagSamples(bag)) as samples:
        page = BagPage(server, samples)
        _announce(server, opens)
        page.run(stop)
    server.stop()


def run_page(server: PageServer, namespace: str, opens: bool) -> None:
    """Print the address, open the browser where there is one, and draw until Ctrl-C."""
    stop = StopSignal()
    _announce(server, opens)
    with ros_context(namespace=namespace):
        tell_graph(namespace)
        page = LivePage(server)
        try:
            page.run(stop)
        finally:
            page.close()
    server.stop()


def _announce(server: PageServer, opens: bool) -> None:
    print(server.address, flush=True)
    if opens and any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")):
        webbrowser.open(server.address)
