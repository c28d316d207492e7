"""Controls of the simulated plant: push and reset; in lock-step also the speed."""

from functools import partial
from time import sleep
from typing import Any

import viser

from furuta_sim.settings.nodes import PLANT
from furuta_view.graph_link import GraphLink
from furuta_view.page_layout import Note

# A push: torque [V], and how long it lasts [s].
PUSH_TIME = 0.1
PUSHES = {"push arm": "pushes.arm", "push pendulum": "pushes.pendulum"}
LEFT, RIGHT = "− ←", "→ +"
SIZES = ("pushes.arm", "pushes.pendulum", "pushes.base_x", "pushes.base_y")
# A push that has begun and does not end by itself.
BEGUN = {"pushes.times": [0.0], "pushes.durations": [1e6]}
# Speeds relative to real time; None: as fast as the machine allows.
FASTEST = "as fast as possible"
SPEEDS: dict[str, float | None] = {
    "paused": 0.0,
    "slow, 1/10": 0.1,
    "half": 0.5,
    "real time": 1.0,
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
            gui.add_button_group(label, (LEFT, RIGHT)).on_click(partial(self._push, parameter))
        reset = gui.add_button("Reset: pendulum upright", icon=viser.Icon.RESTORE)
        reset.on_click(lambda _: link.requests.submit("reset", link.reset, note.fail))
        self._speed = gui.add_dropdown("speed", list(SPEEDS), initial_value=FASTEST, visible=False)
        self._speed.on_update(lambda _: setattr(self.pacer, "speed", SPEEDS[self._speed.value]))

    def show_pacing(self, lockstep: bool) -> None:
        """Show the speed in lock-step only."""
        if self._speed.visible != lockstep:
            self._speed.visible = lockstep

    def _push(self, parameter: str, event: Any) -> None:
        size = self._push_size.value * (1.0 if event.target.value == RIGHT else -1.0)
        work = partial(self._push_now, parameter, size)
        self._link.requests.submit("push", work, self._note.fail)

    def _push_now(self, parameter: str, size: float) -> None:
        """Push by parameters: begin a push without end, and end it after a while."""
        parameters = self._link.parameters
        before = parameters.get(PLANT, [*BEGUN, *SIZES])
        try:
            others = {name: [0.0] for name in SIZES}
            parameters.set_all(PLANT, others | BEGUN | {parameter: [size]})
            sleep(PUSH_TIME)
        finally:
            parameters.set_all(PLANT, {name: list(value) for name, value in before.items()})
