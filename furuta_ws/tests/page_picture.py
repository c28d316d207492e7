"""Makes the moving pictures of the documentation from the page in one file.

make page; python page_picture.py ../../output/furuta.html ../../docs

Their time is the page's own, so that they run evenly on any machine.
"""

import io
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from browser import open_browser
from PIL import Image

RATE = 12  # pictures per second
SCALE, QUALITY = 0.75, 55
# Scenes, and the step with the recommended compensation.
COMPENSATE, UPSET, RECOMMENDED = 2, 4, 3


def pictures(page: Any, place: str, seconds: float) -> Iterator[Image.Image]:
    """A part of the page over a time [s]."""
    for _ in range(round(seconds * RATE)):
        page.evaluate(f"page.motion.advance({1000 // RATE}); page.drawing.drawAll(); page.tell()")
        taken = Image.open(io.BytesIO(page.locator(place).screenshot())).convert("RGB")
        yield taken.resize([round(SCALE * length) for length in taken.size])


def compensation(page: Any) -> Iterator[Image.Image]:
    """The limit cycle, then the recommended compensation until it is measured."""
    page.evaluate(f"page.enter({COMPENSATE}, 0); page.motion.advance(25000); page.tell()")
    yield from pictures(page, "body", 3.0)
    page.locator("fieldset input").nth(RECOMMENDED).check()
    yield from pictures(page, "body", 9.0)


def swing_up(page: Any) -> Iterator[Image.Image]:
    """From hanging to upright."""
    page.evaluate(f"page.enter({UPSET}, 2); page.motion.reset(0, Math.PI)")
    yield from pictures(page, "#stage", 6.0)


def main(page_file: str, folder: str) -> None:
    """Write both pictures."""
    with open_browser() as show:
        page = show(Path(page_file).absolute().as_uri()).page
        page.evaluate("page.state.paused = true; page.drawing.simplify(0, true)")
        for name, shown in {"page.webp": compensation, "swing-up.webp": swing_up}.items():
            first, *others = shown(page)
            out = Path(folder, name)
            options: Any = {"save_all": True, "append_images": others, "duration": 1000 // RATE}
            first.save(out, **options, loop=0, quality=QUALITY, method=6)
            print(f"{out}: {1 + len(others)} pictures, {out.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main(*sys.argv[1:])
