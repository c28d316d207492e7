"""The layout of the page: charts at the left, the pendulum in the middle, controls at the right.

A narrow page has all of it in one panel: status and scenes, then controls, then charts.
"""

from html import escape
from typing import Any

import viser

CHARTS_WIDTH, CONTROLS_WIDTH = 440, 360  # [pixels]
BRAND = (0, 60, 110)  # dark enough for white letters on the buttons that viser makes of it
ALARM, INK = "#b91c1c", "#334155"


class Layout:
    """The places of the page, each to be used with ``with``, and the status at the top."""

    def __init__(self, server: viser.ViserServer) -> None:
        gui = server.gui
        gui.configure_theme(show_logo=False, show_share_button=False, brand_color=BRAND)
        gui.set_panel_label("Furuta pendulum")
        gui.main_panel.dock_right()
        gui.main_panel.set_width(CONTROLS_WIDTH)
        charts = gui.add_panel(order=2.0)
        self.charts = charts.add_tab("Charts")
        charts.dock_left()
        charts.set_width(CHARTS_WIDTH)
        charts.expand()  # a narrow page shows panels below each other, collapsed otherwise
        self.status = gui.add_html(status_html("waiting for a running graph", []), order=0.0)
        controls = gui.add_panel(order=1.0)
        controls.dock_below(gui.main_panel)
        with controls.add_tab("Controls"):
            self.main = gui.add_folder("Main parameters")
            self.controls = gui.add_folder("Simulation")
            self.parameters = gui.add_folder("All parameters")


def status_html(title: str, rows: list[tuple[str, str]]) -> str:
    """A title and a table of figures."""
    cells = "".join(
        f'<tr><td style="color:#475569;padding:0">{escape(name)}</td>'
        '<td style="text-align:right;font-weight:600;white-space:nowrap;padding:0">'
        f"{escape(value)}</td></tr>"
        for name, value in rows
    )
    return (
        f'<div class="status" style="padding:0 10px;font-size:13px"><b>{escape(title)}</b>'
        f'<table style="width:100%;font-size:13px;line-height:1.3;'
        f'font-variant-numeric:tabular-nums">{cells}</table></div>'
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
