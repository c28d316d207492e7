"""The server of the page: viser, reached from this machine and from its own page only."""

from __future__ import annotations

import contextlib
import http
import io
import secrets
import socket
from collections.abc import Callable, Iterator
from functools import wraps
from typing import Any

import viser
from websockets.asyncio import server as websockets_server
from websockets.datastructures import Headers
from websockets.http11 import Response

from furuta_model.parameters import ParameterError
from furuta_view.access import Access, Request, is_local

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

    def __init__(self, address: str = "127.0.0.1", port: int | None = None) -> None:
        free = _free_port(address, port)
        access = Access(free, "" if is_local(address) else secrets.token_urlsafe(16))
        # viser prints on standard output, whose first line is the address of the page.
        with _checked(access), contextlib.redirect_stdout(io.StringIO()):
            super().__init__(host=address, port=free, verbose=False)
        if self.get_port() != free:
            self.stop()
            raise ParameterError(f"port {free} was taken meanwhile; try again")
        query = f"/?token={access.token}" if access.token else ""
        self.address = f"http://{address}:{free}{query}"

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Refuse to share the page through a server elsewhere."""
        return None

    def stop(self) -> None:
        """End the server."""
        with contextlib.redirect_stdout(io.StringIO()):
            super().stop()


def _free_port(address: str, port: int | None) -> int:
    """The port that was chosen, or the first free one from the usual one on.

    Raises:
        ParameterError: There is none, or the address is not of this machine.
    """
    tried = [port] if port is not None else range(USUAL_PORT, USUAL_PORT + TRIED)
    for each in tried:
        try:
            with socket.create_server((address, each)) as found:
                return int(found.getsockname()[1])
        except OSError as error:
            reason = error.strerror
    raise ParameterError(f"cannot listen on {address}, port {tried[0]}: {reason}")


@contextlib.contextmanager
def _checked(access: Access) -> Iterator[None]:
    """Servers of web sockets that are made inside the ``with`` block check every request.

    viser has no option for it.
    """
    serve = websockets_server.serve

    @wraps(serve)
    def checked(*arguments: Any, process_request: Callable[..., Any], **options: Any) -> Any:
        return serve(*arguments, process_request=_process(access, process_request), **options)

    websockets_server.serve = checked  # type: ignore[assignment, misc]
    try:
        yield
    finally:
        websockets_server.serve = serve  # type: ignore[misc]


def _process(access: Access, answer: Callable[..., Any]) -> Callable[..., Any]:
    """Refuse a request, or let viser ``answer`` it."""

    def process(connection: Any, request: Any) -> Any:
        asked = _described(request)
        refusal = access.refusal(asked)
        if refusal:
            return connection.respond(http.HTTPStatus.FORBIDDEN, refusal + "\n")
        response = answer(connection, request)
        if isinstance(response, Response):
            _protect(response.headers, access.cookie_to_set(asked))
        return response

    return process


def _described(request: Any) -> Request:
    def header(name: str) -> str:
        values = request.headers.get_all(name)
        return values[0] if len(values) == 1 else ""

    return Request(
        path=request.path,
        host=header("Host"),
        origin=header("Origin"),
        cookie=header("Cookie"),
        is_socket=bool(request.headers.get("Upgrade")),
    )


def _protect(headers: Headers, cookie: str) -> None:
    headers["Content-Security-Policy"] = POLICY
    headers["Cache-Control"] = "no-store"
    if cookie:
        headers["Set-Cookie"] = cookie
