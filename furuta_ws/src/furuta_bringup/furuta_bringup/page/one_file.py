"""The page in one file, as ``docs/site/one_page.py --package`` has built it into the package."""

import gzip
import os
import sys
import webbrowser
from importlib.resources import files

PACKED = "furuta.html.gz"


def one_file() -> bytes:
    """The page, HTML with all that it needs; it computes the closed loop itself."""
    return gzip.decompress(files(__package__).joinpath(PACKED).read_bytes())


def open_in_browser(address: str) -> None:
    """Open an address where there is a browser with a window; on Linux it needs a display."""
    has_window = any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))
    if has_window or sys.platform != "linux":
        webbrowser.open(address)
