"""A headless Chromium for tests of the page, and what a user sees and does in it."""

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
# WebGL without graphics hardware, and no request of the browser's own. Chromium puts the page
# together by its own means then; `--use-angle=swiftshader` would do that by WebGL too, which takes
# twice the time.
OPTIONS = [
    *("--no-sandbox", "--enable-unsafe-swiftshader"),
    *("--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync"),
]
TIMEOUT = 240.0  # [s]
CANVAS = "canvas[data-engine]"  # of the pendulum in 3D


def browser_path() -> str:
    """The browser; skips the test, with the reason, where there is none or nothing to drive it."""
    pytest.importorskip("playwright", reason="playwright is not installed; `make test` installs it")
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        pytest.skip(f"no browser to show the page in: none of {', '.join(NAMES)} is installed")
    return found


class Page:
    """An open page, with its console (kind and text of each message) and all that it requested."""

    def __init__(self, page: Any, address: str) -> None:
        self.page, self.address = page, address
        self.console: list[tuple[str, str]] = []
        self.requests: list[str] = []
        page.on("pageerror", lambda error: self.console.append(("error", str(error))))
        page.on("console", lambda message: self.console.append((message.type, message.text)))
        page.on("request", lambda request: self.requests.append(request.url))
        page.on("websocket", lambda socket: self.requests.append(socket.url))
        page.set_default_timeout(1e3 * TIMEOUT)
        page.goto(address)
        page.wait_for_selector(CANVAS)

    @property
    def errors(self) -> list[str]:
        """Everything that went wrong in the page."""
        return [text for kind, text in self.console if kind == "error"]

    def wait(self, condition: Callable[[], Any], what: str) -> Any:
        """Wait until a condition holds; returns its value."""
        end = monotonic() + TIMEOUT
        while not (value := condition()):
            assert monotonic() < end, f"never: {what}; {self.console}; {self.text('body')}"
            self.page.wait_for_timeout(100)
        return value

    def text(self, selector: str) -> str:
        """All visible text of the elements."""
        return " ".join(self.page.locator(selector).all_inner_texts())

    def press(self, button: str) -> None:
        """Press the first button with this name."""
        self.page.get_by_role("button", name=button, exact=True).first.click()

    def serious_violations(self, selector: str) -> list[str]:
        """What axe-core finds serious in the elements; skips the test where it is not installed."""
        reason = "axe-playwright-python is not installed; `make test` installs it"
        axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason=reason).Axe()
        found = axe.run(self.page, context=selector).response["violations"]
        return [each["id"] for each in found if each["impact"] in ("serious", "critical")]


@contextmanager
def open_browser() -> Iterator[Callable[..., Page]]:
    """A function that opens an address in a page of a width and height [pixels].

    Further arguments are those of a context of playwright.
    """
    path = browser_path()
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - not where it is skipped

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=OPTIONS)
        try:

            def show(address: str, width: int = 1280, height: int = 800, **about: Any) -> Page:
                size: Any = {"width": width, "height": height}
                return Page(browser.new_page(viewport=size, **about), address)

            yield show
        finally:
            browser.close()
