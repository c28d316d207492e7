"""Runs the page over a running graph: the process behind ``furuta view``."""

from __future__ import annotations

import os
import webbrowser
from pathlib import Path

from furuta_ros.context import ros_context
from furuta_ros.spinning import StopSignal
from furuta_view.live_page import LivePage
from furuta_view.server import PageServer

# Where recordings are made that the page begins.
RECORDINGS = Path("output")


def run_page(server: PageServer, namespace: str, opens: bool) -> None:
    """Print the address, open the browser where there is one, and draw until Ctrl-C."""
    stop = StopSignal()
    print(server.address, flush=True)
    if opens and any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")):
        webbrowser.open(server.address)
    with ros_context(namespace=namespace):
        page = LivePage(server, RECORDINGS)
        try:
            page.run(stop)
        finally:
            page.close()
    server.stop()
