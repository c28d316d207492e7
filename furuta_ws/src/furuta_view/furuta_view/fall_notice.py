"""Says that the simulated pendulum has fallen, and offers the way back."""

from collections.abc import Callable
from math import inf, pi, tau
from typing import Any

import viser

from furuta_graph.settings.nodes import CONTROLLER, PLANT
from furuta_view.exact_cycle import Values
from furuta_view.page_layout import ALARM

RESET = "Reset: pendulum upright"
TEXT = (
    f'<div class="fallen" role="alert" style="background:{ALARM};color:white;margin:0 10px 6px;'
    'padding:4px 8px;font-size:15px"><b>The pendulum has fallen.</b> Reset puts it upright.</div>'
)


class FallNotice:
    """A notice with a button at the top of the page, and the key R."""

    def __init__(self, gui: Any, reset: Callable[[], None]) -> None:
        text = gui.add_html(TEXT, visible=False, order=-0.6)
        button = gui.add_button(RESET, icon=viser.Icon.RESTORE, visible=False, order=-0.5)
        button.on_click(lambda _: reset())
        gui.add_command(RESET, hotkey="R").on_trigger(lambda _: reset())
        self._handles = (text, button)

    def show(self, fallen: bool, values: Values) -> None:
        """Show it after a fall, unless the controller swings the pendulum up."""
        swings = values.get(CONTROLLER, {}).get("mode") == "swing_up"
        for handle in self._handles:
            handle.visible = fallen and PLANT in values and not swings


def has_fallen(theta: float, values: Values) -> bool:
    """Whether the controller gives up at the pendulum angle θ [rad], of any turn."""
    limit = float(values.get(CONTROLLER, {}).get("fall_angle", inf))
    return abs((theta + pi) % tau - pi) > limit
