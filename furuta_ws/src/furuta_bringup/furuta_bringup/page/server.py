"""The server of the page: viser, reached from this machine and from its own page only.

A browser lets any web page that its user visits open a web socket to this machine; only the header
``Origin`` tells them apart. A page whose host name is made to point to this machine shows itself by
the header ``Host``.
"""

import contextlib
import http
import io
import os
import socket
import webbrowser
from collections.abc import Callable, Iterator
from functools import wraps
from typing import Any

import viser
from websockets.asyncio import server as websockets_server
from websockets.datastructures import Headers
from websockets.http11 import Response

from furuta_model.parameters import ParameterError

# viser would listen on all addresses.
ADDRESS = "127.0.0.1"
NAMES = (ADDRESS, "localhost")
USUAL_PORT = 8080
# Ports that are tried from the usual one on, if none was chosen.
TRIED = 50
# The page holds everything that it needs; it may connect to nothing else and be framed by nobody.
POLICY = (
    "default-src 'self' 'unsafe-inline' 'unsafe-eval' data: blob:; "
    "connect-src 'self' ws: data: blob:; frame-ancestors 'none'"
)


class PageServer(viser.ViserServer):
    """A viser server that refuses requests of other pages; ``address`` opens its page."""

    def __init__(self, port: int | None = None) -> None:
        free = _free_port(port)
        # viser prints on standard output, whose first line is the address of the page.
        with _checked_requests(free), contextlib.redirect_stdout(io.StringIO()):
            super().__init__(host=ADDRESS, port=free, verbose=False)
        if self.get_port() != free:
            self.stop()
            raise ParameterError(f"port {free} was taken meanwhile; try again")
        self.address = f"http://{ADDRESS}:{free}"

    def announce(self, opens: bool) -> None:
        """Print the address, and open the browser where there is one."""
        print(self.address, flush=True)
        if opens and any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")):
            webbrowser.open(self.address)

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Refuse to share the page through a server elsewhere."""
        return None

    def stop(self) -> None:
        """End the server."""
        with contextlib.redirect_stdout(io.StringIO()):
            super().stop()


def _free_port(chosen: int | None) -> int:
    """The port that was chosen, or the first free one from the usual one on."""
    tried = [chosen] if chosen is not None else range(USUAL_PORT, USUAL_PORT + TRIED)
    for port in tried:
        try:
            with socket.create_server((ADDRESS, port)):
                return port
        except OSError as error:
            reason = error.strerror
    raise ParameterError(f"cannot listen on {ADDRESS}, port {tried[0]}: {reason}")


@contextlib.contextmanager
def _checked_requests(port: int) -> Iterator[None]:
    """Servers of web sockets that are made inside the ``with`` block check every request.

    viser has no option for it.
    """
    serve = websockets_server.serve

    @wraps(serve)
    def checked(*arguments: Any, process_request: Callable[..., Any], **options: Any) -> Any:
        return serve(*arguments, process_request=_process(port, process_request), **options)

    websockets_server.serve = checked  # type: ignore[assignment, misc]
    try:
        yield
    finally:
        websockets_server.serve = serve  # type: ignore[misc]


def _process(port: int, answer: Callable[..., Any]) -> Callable[..., Any]:
    """Refuse a request, or let viser ``answer`` it."""

    def process(connection: Any, request: Any) -> Any:
        reason = refusal(request.headers, port)
        if reason:
            return connection.respond(http.HTTPStatus.FORBIDDEN, reason + "\n")
        response = answer(connection, request)
        if isinstance(response, Response):
            response.headers["Content-Security-Policy"] = POLICY
            response.headers["Cache-Control"] = "no-store"
        return response

    return process


def refusal(headers: Headers, port: int) -> str:
    """Why a request to the server on ``port`` is refused; empty if it is not."""
    hosts = headers.get_all("Host")
    if len(hosts) != 1 or hosts[0] not in [f"{name}:{port}" for name in NAMES]:
        return f"this page is at http://{ADDRESS}:{port} only"
    origins = headers.get_all("Origin")
    if headers.get_all("Upgrade") and origins != [f"http://{hosts[0]}"]:
        return f"a page of {', '.join(origins) or 'unknown origin'} must not connect"
    return ""
