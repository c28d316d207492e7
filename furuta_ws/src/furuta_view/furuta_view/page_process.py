"""Runs the page over a running graph: the process behind ``furuta view``."""

from furuta_ros.context import ros_context, tell_graph
from furuta_ros.process_end import StopSignal
from furuta_view.live_page import LivePage
from furuta_view.server import PageServer


def run_page(server: PageServer, namespace: str, opens: bool) -> None:
    """Print the address, open the browser where there is one, and draw until Ctrl-C."""
    stop = StopSignal()
    server.announce(opens)
    with ros_context(namespace=namespace):
        tell_graph(namespace)
        page = LivePage(server)
        try:
            page.run(stop)
        finally:
            page.close()
    server.stop()
