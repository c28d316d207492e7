"""Controls of a rig: arm and disarm, and what the bridge says."""

from functools import partial
from html import escape
from typing import Any

import viser

from furuta_bringup.page.graph_link import GraphLink
from furuta_bringup.page.jobs import Work
from furuta_bringup.page.page_layout import ALARM, INK, Note

# The bridge publishes its diagnostics once a second; older ones say nothing about now [s].
OLDEST_STATUS = 4.0
ARMED = "#b45309"


class RigControls:
    """A panel of its own that is always in sight.

    A narrow page shows one panel at a time. So the main panel begins with the status and *Disarm*.
    ``shown`` is the element with the status.
    """

    def __init__(self, server: Any, link: GraphLink) -> None:
        self._link, gui = link, server.gui
        disarm = partial(self._call, link.bridge.disarm)
        self._in_main_panel = gui.add_html("", order=-2.0)
        in_main = gui.add_button("Disarm", color="red", icon=viser.Icon.HAND_STOP, order=-1.0)
        panel = gui.add_panel(order=-1.0)
        with panel.add_tab("Rig"):
            self.shown = gui.add_html("")
            stop = gui.add_button("Disarm: 0 V", color="red", icon=viser.Icon.HAND_STOP)
            start = gui.add_button("Arm", color="green", icon=viser.Icon.PLAYER_PLAY)
            self._note = Note(gui, 9.0)
        panel.dock_above(gui.main_panel)
        in_main.on_click(disarm)
        stop.on_click(disarm)
        start.on_click(partial(self._call, link.bridge.arm))

    def show(self, status: Any, age: float) -> None:
        """Show the newest diagnostics of the bridge and their age [s], or that there are none."""
        if status is None:
            self._tell("not armed", INK, "no diagnostics from the bridge")
        elif age > OLDEST_STATUS:
            self._tell("unknown", ALARM, f"the bridge has been silent for {age:.0f} s")
        else:
            values = {pair.key: pair.value for pair in status.values}
            title, colour = ("ARMED", ARMED) if values["armed"] == "True" else ("not armed", INK)
            below = f"{values['state']}, stops: {values['stops']}"
            self._tell(title, colour, status.message, below)

    def _call(self, work: Work, _: Any) -> None:
        self._note.tell("")
        self._link.arming.submit("arm", work, self._note.fail)

    def _tell(self, title: str, colour: str, text: str, below: str = "") -> None:
        content = (
            f'<div class="rig" style="padding:2px 8px;font-size:16px"><b style="color:{colour}">'
            f"{escape(title)}</b>: {escape(text)}<br>{escape(below)}</div>"
        )
        if self.shown.content != content:
            self.shown.content = self._in_main_panel.content = content
