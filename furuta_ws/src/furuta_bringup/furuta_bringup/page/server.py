"""The server of the page: its files, and a web socket, for this machine and its own page only.

A browser lets any web page that its user visits open a web socket to this machine; only the header
``Origin`` tells them apart. A page whose host name is made to point to this machine shows itself by
the header ``Host``.
"""

import base64
import gzip
import http
import json
import socket
from collections.abc import Callable
from contextlib import suppress
from importlib.resources import files
from pathlib import Path
from typing import Any

from websockets.asyncio.server import ServerConnection, broadcast, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from furuta_bringup.page.guided_scenes import page_content
from furuta_bringup.page.one_file import open_in_browser
from furuta_model.parameters import ParameterError

ADDRESS = "127.0.0.1"
NAMES = (ADDRESS, "localhost")
DATA = b"@data@"  # in the page, for what it shows
USUAL_PORT = 8080
# Ports that are tried from the usual one on, if none was chosen.
TRIED = 50
# The page may use and connect to nothing but this server, and be framed by nobody.
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src blob: data:; "
    "connect-src 'self'; frame-ancestors 'none'"
)
KINDS = {".html": "text/html", ".css": "text/css", ".js": "text/javascript"}
# Bytes of one message of a page, and those that wait for a slow page, which then misses samples.
LONGEST, BEHIND = 1 << 16, 1 << 18


def page_files() -> dict[str, tuple[str, bytes]]:
    """Kind and content of each file of the page by its path, with what the page shows."""
    content = base64.b64encode(gzip.compress(json.dumps(page_content()).encode(), mtime=0))
    found = {}
    for file in files(__package__).joinpath("web").iterdir():
        kind = KINDS.get(Path(file.name).suffix)
        if kind:
            found[f"/{file.name}"] = kind, file.read_bytes().replace(DATA, content)
    found["/"] = found.pop("/page.html")
    return found


class PageServer:
    """Serves files and sends to all open pages; ``address`` opens the page.

    What is told stays known by its key, and a page that opens hears all of it, and ``history()``.
    ``received`` is called with each object that a page sends. All methods are called in the thread
    of the loop.
    """

    def __init__(self, port: int | None = None) -> None:
        self._files, self._socket = page_files(), _free_socket(port)
        self.port: int = self._socket.getsockname()[1]
        self.address = f"http://{ADDRESS}:{self.port}"
        self.received: Callable[[dict[str, Any]], None] = lambda message: None
        self.history: Callable[[], bytes] = bytes
        self.known: dict[str, Any] = {}
        self._pages: set[ServerConnection] = set()

    def __len__(self) -> int:
        """How many pages are open."""
        return len(self._pages)

    def announce(self, opens: bool) -> None:
        """Print the address, and open the browser where there is one."""
        print(self.address, flush=True)
        if opens:
            open_in_browser(self.address)

    def serving(self) -> serve:
        """What serves, as an asynchronous context."""
        return serve(
            self._serve,
            sock=self._socket,
            process_request=self._answer,
            compression=None,
            max_size=LONGEST,
        )

    def tell(self, **keys: Any) -> None:
        """Tell what has changed."""
        new = {key: value for key, value in keys.items() if self.known.get(key) != value}
        self.known |= new
        if new:
            self.say(**new)

    def say(self, **keys: Any) -> None:
        """Tell the pages that are open now, and no later one."""
        broadcast(self._pages, json.dumps(keys))

    def send(self, rows: bytes) -> None:
        """Send samples to the pages that keep up."""
        keep_up = [p for p in self._pages if p.transport.get_write_buffer_size() < BEHIND]
        broadcast(keep_up, rows)

    async def _serve(self, page: ServerConnection) -> None:
        broadcast([page], json.dumps(self.known))
        broadcast([page], self.history())
        self._pages.add(page)
        try:
            async for message in page:
                with suppress(ValueError, RecursionError):  # no JSON, or too deep
                    if isinstance(heard := json.loads(message), dict):
                        self.received(heard)
        except ConnectionClosed:
            pass
        finally:
            self._pages.discard(page)

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """Refuse a request, answer it with the page, or let it open a web socket."""
        reason = refusal(request.headers, self.port)
        if reason:
            return connection.respond(http.HTTPStatus.FORBIDDEN, reason + "\n")
        if request.headers.get("Upgrade"):
            return None
        if request.path not in self._files:
            return connection.respond(http.HTTPStatus.NOT_FOUND, "no such file\n")
        kind, content = self._files[request.path]
        about = {
            "Content-Type": f"{kind}; charset=utf-8",
            "Content-Length": str(len(content)),
            "Content-Security-Policy": POLICY,
            "X-Content-Type-Options": "nosniff",
            "Cache-Control": "no-store",
            "Connection": "close",
        }
        return Response(http.HTTPStatus.OK, "OK", Headers(about), content)


def _free_socket(chosen: int | None) -> socket.socket:
    """One on the port that was chosen, or on the first free one from the usual one on."""
    tried = [chosen] if chosen is not None else range(USUAL_PORT, USUAL_PORT + TRIED)
    for port in tried:
        try:
            return socket.create_server((ADDRESS, port))
        except OSError as error:
            reason = error.strerror
    raise ParameterError(f"cannot listen on {ADDRESS}, port {tried[0]}: {reason}")


def refusal(headers: Headers, port: int) -> str:
    """Why a request to the server on ``port`` is refused; empty if it is not."""
    hosts = headers.get_all("Host")
    if len(hosts) != 1 or hosts[0] not in [f"{name}:{port}" for name in NAMES]:
        return f"this page is at http://{ADDRESS}:{port} only"
    origins = headers.get_all("Origin")
    if headers.get_all("Upgrade") and origins != [f"http://{hosts[0]}"]:
        return f"a page of {', '.join(origins) or 'unknown origin'} must not connect"
    return ""
