"""The layout of the page: charts at the left, the pendulum in the middle, controls at the right.

A narrow page has all of it in one panel: status and scenes, then controls, then charts.
"""

from html import escape
from typing import Any

import viser

CHARTS_WIDTH, CONTROLS_WIDTH = 440, 360  # [pixels]
BRAND = (0, 60, 110)  # dark enough for white letters on the buttons that viser makes of it
ALARM, INK = "#b91c1c", "#334155"
RUNNING = 'aria-current="step" style="background:#e0eefa;font-weight:600"'
WAITING = (
    "<b>Waiting for a running graph.</b> Start one with <code>furuta run</code>, or open this page "
    "with <code>furuta view</code>, which starts one."
)
# viser's labels are 7 letters wide, its panels of one height, and it leaves part of a phone unused.
STYLE = """<style>
div:has(> p > label) { width: 42% !important }
[data-dock-scroll] > div:has(.scene) { min-height: min(400px, 100% - 60px) !important }
[data-dock-scroll] > div:has(.fallen) { min-height: min(475px, 100% - 60px) !important }
.uplot .u-title { padding: 0; font-weight: 600 }
.uplot .u-legend { font-size: 12px }
@media (max-width: 576px) { [style*="width: 20em"] { width: 100vw !important } }
</style>"""


class Layout:
    """The places of the page, each to be used with ``with``, and the status at the top."""

    def __init__(self, server: viser.ViserServer) -> None:
        gui = server.gui
        gui.configure_theme(show_logo=False, show_share_button=False, brand_color=BRAND)
        gui.set_panel_label("Furuta pendulum")
        gui.main_panel.dock_right()
        gui.main_panel.set_width(CONTROLS_WIDTH)
        gui.add_html(STYLE, order=9.0)
        charts = gui.add_panel(order=2.0)
        self.charts = charts.add_tab("Charts")
        charts.dock_left()
        charts.set_width(CHARTS_WIDTH)
        charts.expand()  # a narrow page shows panels below each other, collapsed otherwise
        self.status = gui.add_html(status_html(WAITING, []), order=0.0)
        controls = gui.add_panel(order=1.0)
        controls.dock_below(gui.main_panel)
        with controls.add_tab("Controls"):
            self.main = gui.add_folder("Main parameters")
            self.controls = gui.add_folder("Simulation")
            self.parameters = gui.add_folder("All parameters")


def status_html(title: str, rows: list[tuple[str, str]]) -> str:
    """A title, in HTML, and a table of figures."""
    return f'<div style="padding:0 10px;font-size:13px">{table_html(title, rows)}</div>'


def table_html(title: str, rows: list[tuple[str, str]], running: int = -1) -> str:
    """Names and values under a title in HTML; that of the row which is ``running`` stands out."""
    cells = "".join(
        f'<tr {RUNNING if number == running else ""}><td style="padding:0 2px">'
        f"{escape(name)}</td>"
        '<td style="text-align:right;font-weight:600;white-space:nowrap;padding:0 2px">'
        f"{escape(value)}</td></tr>"
        for number, (name, value) in enumerate(rows)
    )
    return (
        f'<div class="status">{title}<table style="width:100%;font-size:13px;'
        f'line-height:1.4;border-collapse:collapse;font-variant-numeric:tabular-nums">{cells}'
        "</table></div>"
    )


class Note:
    """A line under controls that says what happened last; ``kind`` is its class in the page."""

    def __init__(self, gui: Any, order: float, kind: str = "note") -> None:
        self._handle = gui.add_html("", visible=False, order=order)
        self._kind = kind

    def tell(self, text: str, colour: str = INK) -> None:
        """Show a sentence, or nothing."""
        self._handle.content = (
            f'<div class="{self._kind}" style="color:{colour};font-size:14px;padding:0 8px 6px">'
            f"{escape(text)}</div>"
        )
        self._handle.visible = bool(text)

    def fail(self, reason: str) -> None:
        """Show why something failed."""
        self.tell(reason, ALARM)
