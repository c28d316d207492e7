"""Which requests the page's server answers: a foreign page must not reach a parameter."""

import asyncio
import http.client
import json
import re
import socket
import threading
from collections.abc import Iterator
from urllib.parse import urlsplit

import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Origin

from furuta_bringup.page.server import PageServer


@pytest.fixture(scope="module")
def server() -> Iterator[PageServer]:
    """A server in a thread."""
    server = PageServer(port=0)
    server.tell(place={"scene": 2})
    loop, ends = asyncio.new_event_loop(), asyncio.Event()

    async def serve() -> None:
        async with server.serving():
            await ends.wait()

    thread = threading.Thread(target=loop.run_until_complete, args=[serve()])
    thread.start()
    yield server
    loop.call_soon_threadsafe(ends.set)
    thread.join()


def open_socket(server: PageServer, origin: str | None, host: str = "") -> None:
    """Open the web socket as a page of ``origin`` does; raises InvalidStatus if it is refused."""
    place = urlsplit(server.address).netloc
    with connect(
        f"ws://{host or place}",
        origin=Origin(origin) if origin else None,
        sock=socket.create_connection(("127.0.0.1", server.port)),
    ) as opened:
        assert json.loads(opened.recv(timeout=30.0)) == {"place": {"scene": 2}}


def test_own_page_connects(server: PageServer) -> None:
    """By both names of this machine."""
    open_socket(server, server.address)
    name = f"localhost:{server.port}"
    open_socket(server, f"http://{name}", name)


@pytest.mark.parametrize("origin", [None, "http://evil.example", "https://127.0.0.1:{port}"])
def test_foreign_origin_is_refused(server: PageServer, origin: str | None) -> None:
    """Another site, a file, another program on this machine, and a program without a page."""
    given = origin and origin.format(port=server.port)
    with pytest.raises(InvalidStatus) as refused:
        open_socket(server, given)
    assert refused.value.response.status_code == http.HTTPStatus.FORBIDDEN


def test_foreign_name_for_this_machine_is_refused(server: PageServer) -> None:
    """A site whose name is made to point here has an origin that fits its own name."""
    name = f"evil.example:{server.port}"
    with pytest.raises(InvalidStatus):
        open_socket(server, f"http://{name}", name)


def answer(server: PageServer, path: str) -> tuple[int, str, str]:
    """Status, policy and content."""
    asked = http.client.HTTPConnection("127.0.0.1", server.port, timeout=30.0)
    asked.request("GET", path)
    got = asked.getresponse()
    return got.status, got.headers.get("Content-Security-Policy", ""), got.read().decode()


def test_page_may_not_be_framed_and_requests_nothing_elsewhere(server: PageServer) -> None:
    """Otherwise a foreign page could lead clicks to the button that arms a rig."""
    status, policy, html = answer(server, "/")
    assert status == http.HTTPStatus.OK
    assert "frame-ancestors 'none'" in policy
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert "@data@" not in html
    scripts = re.findall(r'(?:src|href)="([^"]+[.](?:js|css))"', html)
    assert {"page.js", "page.css"} <= set(scripts)
    for path in scripts:
        assert answer(server, f"/{path}")[0] == http.HTTPStatus.OK


@pytest.mark.parametrize(
    "path", ["/page.html", "/../server.py", "/three.LICENSE", "/%2e%2e/x", "//"]
)
def test_server_has_the_files_of_the_page_only(server: PageServer, path: str) -> None:
    assert answer(server, path)[0] == http.HTTPStatus.NOT_FOUND


def test_server_listens_on_this_machine_only(server: PageServer) -> None:
    """Not on all addresses."""
    with pytest.raises(OSError, match="refused"):
        socket.create_connection(("127.0.0.2", server.port), timeout=5.0)
