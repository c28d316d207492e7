"""Makes the picture of the page in the documentation from the running product.

python view_picture.py ../../docs/view.png [WIDTH HEIGHT]
"""

import subprocess
import sys

from browser import Page, open_browser

from furuta_bringup.graph.processes import executable

COMMAND = ["view", "--no-open", "--", "--lockstep"]
COMPENSATE, LUGRE = 2, 2  # scene and step


def show_compensation(page: Page) -> None:
    """Let LuGre compensation end the limit cycle in the middle of the charts."""
    page.wait(lambda: page.page.evaluate("page.motion.result"), "the limit cycle")
    page.page.evaluate(f"page.enter({COMPENSATE}, {LUGRE})")
    page.wait(lambda: page.page.evaluate("page.motion.result"), "less of it")
    page.page.evaluate("page.tell()")


def main(path: str, width: str = "1280", height: str = "800") -> None:
    """Start the view, and take its picture."""
    furuta = str(executable("furuta_bringup", "furuta"))
    with subprocess.Popen([furuta, *COMMAND], stdout=subprocess.PIPE, text=True) as view:
        assert view.stdout is not None
        try:
            with open_browser() as show:
                page = show(view.stdout.readline().strip(), int(width), int(height))
                show_compensation(page)
                page.page.screenshot(path=path)
        finally:
            view.terminate()


if __name__ == "__main__":
    main(*sys.argv[1:])
