"""Controls of the simulated plant: push, reset, notice of a fall; in lock-step also the speed."""

from collections.abc import Callable
from functools import partial
from math import inf, pi, tau
from typing import Any

import viser

from furuta.settings.nodes import CONTROLLER, PLANT
from furuta_bringup.page.graph_link import GraphLink
from furuta_bringup.page.guided_scenes import Values
from furuta_bringup.page.page_layout import ALARM, Note

RESET = "Reset: pendulum upright"
TEXT = (
    f'<div class="fallen" role="alert" style="background:{ALARM};color:white;margin:0 10px 6px;'
    'padding:3px 8px;font-size:14px"><b>The pendulum has fallen.</b></div>'
)
PUSHES = {"push arm": "pushes.arm", "push pendulum": "pushes.pendulum"}
CLOCKWISE, ANTICLOCKWISE = "clockwise", "anticlockwise"  # seen from above: φ falls, φ rises
# Speeds relative to real time; None: as fast as the machine allows.
FASTEST, REAL_TIME = "as fast as possible", "real time"
SPEEDS: dict[str, float | None] = {
    "paused": 0.0,
    "slow, 1/10": 0.1,
    "half": 0.5,
    REAL_TIME: 1.0,
    "double": 2.0,
    "five times": 5.0,
    FASTEST: None,
}
FOREVER = 1e9  # [s]


class Pacer:
    """Sets how fast a graph in lock-step runs, by the time at which the plant pauses.

    A core without clock; times [s] are arguments.
    """

    def __init__(self) -> None:
        self.speed: float | None = None
        self._until = 0.0
        self._last: float | None = None

    def run_until(self, now: float, plant_time: float) -> float:
        """The time of the plant up to which it may run, at ``now`` of the steady clock."""
        passed = now - self._last if self._last is not None else 0.0
        self._last = now
        if not self.speed:
            self._until = plant_time
            return FOREVER if self.speed is None else plant_time
        # A plant that cannot keep up is not sent ahead.
        self._until = min(max(self._until, plant_time), plant_time + self.speed) + (
            passed * self.speed
        )
        return self._until


class SimulationControls:
    """Buttons and sliders for the plant, and the ``pacer`` that they set."""

    def __init__(self, server: Any, link: GraphLink, note: Note) -> None:
        self._link, self._note, self.pacer = link, note, Pacer()
        gui = server.gui
        self._push_size = gui.add_slider("push size [V]", 0.1, 5.0, 0.1, 1.0)
        for label, parameter in PUSHES.items():
            buttons = gui.add_button_group(
                label, (CLOCKWISE, ANTICLOCKWISE), hint="seen from above, for 0.1 s"
            )
            buttons.on_click(partial(self._push, parameter))
        gui.add_button(RESET, icon=viser.Icon.RESTORE).on_click(lambda _: self.reset())
        self._speed = gui.add_dropdown("speed", list(SPEEDS), initial_value=FASTEST, visible=False)
        self._speed.on_update(lambda _: setattr(self.pacer, "speed", SPEEDS[self._speed.value]))
        self._speed_before = FASTEST

    def reset(self) -> None:
        """Put the pendulum upright."""
        self._link.requests.submit("reset", self._link.reset, self._note.fail)

    def run_in_real_time(self, real_time: bool) -> None:
        """In lock-step run in real time, or at the speed before."""
        if real_time:
            self._speed_before = self._speed.value
        self._speed.value = REAL_TIME if real_time else self._speed_before

    def show_pacing(self, lockstep: bool) -> None:
        """Show the speed in lock-step only."""
        if self._speed.visible != lockstep:
            self._speed.visible = lockstep

    def _push(self, parameter: str, event: Any) -> None:
        sign = 1.0 if event.target.value == ANTICLOCKWISE else -1.0
        work = partial(self._link.push, parameter, sign * self._push_size.value)
        self._link.requests.submit("push", work, self._note.fail)


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
