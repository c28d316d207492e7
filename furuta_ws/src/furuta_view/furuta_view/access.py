"""Decides which requests a page's server answers: only those of its own page and its user.

A browser lets any web page that its user visits open a web socket to this machine; only the header
``Origin`` tells them apart. A page whose host name is made to point to this machine shows itself by
the header ``Host``.
"""

from __future__ import annotations

from hmac import compare_digest
from http.cookies import CookieError, SimpleCookie
from ipaddress import ip_address
from typing import NamedTuple
from urllib.parse import parse_qs, urlsplit

LOCAL_NAMES = ("127.0.0.1", "localhost", "[::1]")
COOKIE = "furuta_view"


class Request(NamedTuple):
    """What the decision needs of a request; an absent header is empty."""

    path: str
    host: str
    origin: str
    cookie: str
    is_socket: bool


class Access(NamedTuple):
    """The rule of a server on ``port``; ``token`` is empty if it is reached from here only."""

    port: int
    token: str = ""

    def refusal(self, request: Request) -> str:
        """Why the request is refused; empty if it is not."""
        local = [f"{name}:{self.port}" for name in LOCAL_NAMES]
        if not self.token and request.host not in local:
            return f"this page is at http://{local[0]} only"
        if request.is_socket and request.origin != f"http://{request.host}":
            return f"a page of {request.origin or 'unknown origin'} must not connect"
        if self.token and not self._knows_token(request):
            return "open the page with the address that the program has printed: it has a token"
        return ""

    def cookie_to_set(self, request: Request) -> str:
        """The cookie that keeps the token of this address for the web socket, if there is one."""
        if not self.token or not self._matches(_token_in(request.path)):
            return ""
        return f"{COOKIE}={self.token}; HttpOnly; SameSite=Strict; Path=/"

    def _knows_token(self, request: Request) -> bool:
        given = _token_in_cookie(request.cookie)
        return self._matches(given) or (not request.is_socket and bool(self.cookie_to_set(request)))

    def _matches(self, given: str) -> bool:
        return compare_digest(given.encode(), self.token.encode())


def is_local(address: str) -> bool:
    """Whether an address to listen on is reached from this machine only."""
    return address == "localhost" or ip_address(address).is_loopback


def _token_in(path: str) -> str:
    return parse_qs(urlsplit(path).query).get("token", [""])[0]


def _token_in_cookie(header: str) -> str:
    try:
        found = SimpleCookie(header).get(COOKIE)
    except CookieError:
        return ""
    return found.value if found else ""
