"""Which requests the page's server answers: a foreign page must not reach a parameter."""

import http.client
import socket
from collections.abc import Iterator
from urllib.parse import urlsplit

import pytest
import viser
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Origin, Subprotocol

from furuta_bringup.page.server import PageServer

PROTOCOL = Subprotocol(f"viser-v{viser.__version__}")


@pytest.fixture(scope="module")
def server() -> Iterator[PageServer]:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    server = PageServer(port=port)
    yield server
    server.stop()


def open_socket(server: PageServer, origin: str | None, host: str = "") -> None:
    """Open the web socket as a page of ``origin`` does; raises InvalidStatus if it is refused."""
    place = urlsplit(server.address).netloc
    with connect(
        f"ws://{host or place}",
        origin=Origin(origin) if origin else None,
        subprotocols=[PROTOCOL],
        sock=socket.create_connection(("127.0.0.1", server.get_port())),
    ) as opened:
        assert opened.recv(timeout=30.0)


def test_own_page_connects(server: PageServer) -> None:
    """By both names of this machine."""
    open_socket(server, server.address)
    name = f"localhost:{server.get_port()}"
    open_socket(server, f"http://{name}", name)


@pytest.mark.parametrize("origin", [None, "http://evil.example", "https://127.0.0.1:{port}"])
def test_foreign_origin_is_refused(server: PageServer, origin: str | None) -> None:
    """Another site, a file, another program on this machine, and a program without a page."""
    given = origin and origin.format(port=server.get_port())
    with pytest.raises(InvalidStatus) as refused:
        open_socket(server, given)
    assert refused.value.response.status_code == http.HTTPStatus.FORBIDDEN


def test_foreign_name_for_this_machine_is_refused(server: PageServer) -> None:
    """A site whose name is made to point here has an origin that fits its own name."""
    name = f"evil.example:{server.get_port()}"
    with pytest.raises(InvalidStatus):
        open_socket(server, f"http://{name}", name)


def test_page_may_not_be_framed_and_requests_nothing_elsewhere(server: PageServer) -> None:
    """Otherwise a foreign page could lead clicks to the button that arms a rig."""
    asked = http.client.HTTPConnection("127.0.0.1", server.get_port(), timeout=30.0)
    asked.request("GET", "/")
    answer = asked.getresponse()
    policy = answer.headers["Content-Security-Policy"]
    assert answer.status == http.HTTPStatus.OK
    assert "frame-ancestors 'none'" in policy
    assert "default-src 'self'" in policy


def test_server_listens_on_this_machine_only(server: PageServer) -> None:
    """Not on all addresses, as viser does by default."""
    with pytest.raises(OSError, match="refused"):
        socket.create_connection(("127.0.0.2", server.get_port()), timeout=5.0)
