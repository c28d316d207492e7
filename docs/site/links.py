"""Checks that every local link and picture of the built site leads somewhere.

``python docs/site/links.py output/site`` prints what does not, and then ends with status 1.
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class _Links(HTMLParser):
    """The addresses that a page names, and the places in it that a link can name."""

    def __init__(self, file: Path) -> None:
        super().__init__()
        self.addresses: set[str] = set()
        self.places: set[str] = {""}
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keep ``href``, ``src`` and ``id`` of a tag."""
        given = dict(attrs)
        self.addresses |= {given[name] or "" for name in ("href", "src") if name in given}
        self.places.add(given.get("id") or "")


def broken(site: Path) -> list[str]:
    """The links of all pages that lead to no file, or to no place in it."""
    site = site.resolve()
    pages = {file: _Links(file) for file in sorted(site.rglob("*.html"))}
    found = []
    for file, page in pages.items():
        for address in sorted(page.addresses):
            parts = urlsplit(address)
            if parts.scheme or parts.netloc:
                continue
            target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            place = unquote(parts.fragment)
            in_page = target not in pages or place in pages[target].places or "=" in place
            if not target.exists() or not in_page:
                found.append(f"{file.relative_to(site)}: {address}")
    return found


if __name__ == "__main__":
    sys.exit("\n".join(broken(Path(sys.argv[1]))) or 0)
