"""Makes the picture of the page in the documentation from the running product.

python view_picture.py ../../docs/view.png [WIDTH HEIGHT]
"""

import subprocess
import sys

import numpy as np
from browser import Page, open_browser

from furuta_bringup.graph.processes import executable

COMMAND = ["view", "--no-open", "--", "--lockstep"]
ARM = "arm φ [°]"


def newest(page: Page, part: float) -> float:
    """Peak to peak of the arm in the newest part of the chart [°]; NaN while it is not full."""
    values = page.curve(ARM)
    return float(np.ptp(values[-int(len(values) * part) :])) if len(values) > 600 else np.nan


def show_compensation(page: Page) -> None:
    """Let LuGre compensation end the limit cycle in the middle of the charts."""
    page.close_notice()
    page.choose("speed", "real time")
    page.wait(lambda: newest(page, 1.0) > 25.0, "the limit cycle in a full chart")
    page.choose("Compensation", "LuGre observer")
    page.wait(lambda: newest(page, 0.35) < 3.0, "less of it")


def main(path: str, width: str = "1280", height: str = "800") -> None:
    """Start the view, and take its picture."""
    furuta = str(executable("furuta_bringup", "furuta"))
    with subprocess.Popen([furuta, *COMMAND], stdout=subprocess.PIPE, text=True) as view:
        assert view.stdout is not None
        try:
            with open_browser() as show:
                page = show(view.stdout.readline().strip(), int(width), int(height))
                show_compensation(page)
                page.page.mouse.move(700, 700)  # away from the controls, whose meaning it shows
                page.page.wait_for_timeout(500)
                page.page.screenshot(path=path)
        finally:
            view.terminate()


if __name__ == "__main__":
    main(*sys.argv[1:])
