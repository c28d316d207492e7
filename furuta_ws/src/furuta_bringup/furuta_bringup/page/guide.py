"""The folder of the guided scenes: a scene to choose, its text, and what was measured in it."""

from collections.abc import Callable
from functools import partial
from html import escape
from math import isfinite
from typing import Any

import numpy as np

from furuta.settings.parameter_names import by_node
from furuta_bringup.page.exact_cycle import Values, encoder_counts
from furuta_bringup.page.figures import figures
from furuta_bringup.page.graph_link import GraphLink
from furuta_bringup.page.guided_scenes import (
    guided_steps,
    names_of,
    step_values,
    values_of,
)
from furuta_bringup.page.page_layout import Note, status_html
from furuta_bringup.page.samples import TIME

FREE = "free play"
BACK, NEXT = "back", "next"
HINT = "five guided scenes; free play restores the parameters that they change"
# Time after which a step pushes, and after which it is measured [s]: a transient, and what the
# figures measure.
PUSH_AFTER, SETTLED = 3.0, 8.0
MEASURED = "arm peak to peak, period"


class Guide:
    """Leads through the scenes; in free play the parameters are as they were before.

    ``position`` is that of the step, None in free play. ``values`` gives the parameters of the
    nodes, and ``pace`` sets whether time is real. Where a node or parameter is missing, as on a
    rig, there are no scenes.
    """

    def __init__(
        self, gui: Any, link: GraphLink, values: Callable[[], Values], pace: Callable[[bool], None]
    ) -> None:
        self._link, self._values, self._pace = link, values, pace
        self._steps = guided_steps()
        self._names = names_of(self._steps)
        self._titles = [step.title for step in self._steps]
        self.position: int | None = None
        self._before: dict[str, Any] | None = None
        self._since: float | None = None
        self._fallen = False
        self._measured: dict[int, str] = {}
        self._pushes: dict[str, float] = {}
        self._folder = gui.add_folder(None, order=1.0, visible=False)
        with self._folder:
            self._choice = gui.add_dropdown(
                "scene", [FREE, *dict.fromkeys(self._titles)], hint=HINT
            )
            self._buttons = gui.add_button_group("step", (BACK, NEXT, FREE), visible=False)
            self._text = gui.add_html("", visible=False)
            self._table = gui.add_html("", visible=False)
            self._note = Note(gui, 9.0)
        self._choice.on_update(self._chosen)
        self._buttons.on_click(lambda event: self._pressed(event.target.value))

    def leave(self) -> None:
        """Go to free play: restore what the scenes have changed."""
        if self.position is not None:
            self._go(None)

    def update(self, samples: np.ndarray, fallen: bool, predicted: list[tuple[str, str]]) -> None:
        """Measure the newest samples (n, 8); ``predicted`` are rows of names and values."""
        self._fallen = self._fallen or fallen  # one that swings may pass upright just now
        position = self.position
        self._folder.visible = values_of(self._names, self._values()) is not None
        if position is None or self._link.requests.pending("scene"):
            return
        time = float(samples[-1, TIME])
        if self._since is None or time < self._since:
            self._since = time
        passed = time - self._since
        if passed > PUSH_AFTER:
            self._push()
        if fallen:
            self._measured[position] = "fallen"
        elif passed > SETTLED:
            motion = figures(samples, encoder_counts(self._values()))
            self._measured[position] = motion_text(motion.phi_peak_to_peak, motion.period)
        self._table.content = status_html(MEASURED, [*self._rows(position), *predicted])

    def _rows(self, position: int) -> list[tuple[str, str]]:
        """Name and measurement of each step of the scene."""
        return [
            (f"▸ {step.name}" if place == position else step.name, self._measured.get(place, "…"))
            for place, step in enumerate(self._steps)
            if step.title == self._titles[position]
        ]

    def _place(self, position: int) -> str:
        """Which step of its scene this is, and its name."""
        title, name = self._steps[position].title, self._steps[position].name
        before = self._titles.index(title)
        return f"Step {position - before + 1} of {self._titles.count(title)}, {name}"

    def _chosen(self, event: Any) -> None:
        """Begin the scene that a user has chosen."""
        if event.client is not None:
            title = self._choice.value
            self._go(self._titles.index(title) if title in self._titles else None)

    def _pressed(self, button: str) -> None:
        """One step further or back; after the last one comes free play."""
        steps = range(len(self._steps))
        position = (self.position or 0) + {BACK: -1, NEXT: 1}.get(button, len(steps))
        self._go(position if position in steps else None)

    def _go(self, position: int | None) -> None:
        self.position = position
        for handle in (self._text, self._buttons, self._table):
            handle.visible = position is not None
        if position is None:
            self._choice.value = FREE
        else:
            step = self._steps[position]
            self._measured.pop(position, None)
            self._pushes = {}
            self._choice.value = step.title
            self._text.content = (
                '<div class="scene" role="status" style="padding:0 10px 2px;font-size:13px;'
                f'line-height:1.3">{escape(step.text)}<br><b>{escape(self._place(position))}.</b> '
                f"{escape(step.look)}</div>"
            )
            self._table.content = status_html(MEASURED, self._rows(position))
        self._note.tell("")
        self._link.requests.submit("scene", self._apply, self._note.fail)

    def _apply(self) -> None:
        """Set the parameters of the step, or those that were before the scenes. Called in a job."""
        position = self.position
        self._link.end_push()
        if self._before is None:
            self._before = values_of(self._names, self._values())
            self._pace(True)
        assert self._before is not None  # the folder is hidden otherwise
        step = None if position is None else self._steps[position]
        new = self._before if step is None else step_values(step, self._before, self._values())
        # The controller's modes depend on the estimator: set it after that, and restore it before.
        for node, values in sorted(by_node(new).items(), reverse=step is not None):
            self._link.parameters.set_all(node, values)
        self._since = None
        if self._fallen:
            self._link.reset()
            self._fallen = False
        if step is None:
            self._before = None
            self._pace(False)
        self._pushes = dict(step.push) if step else {}

    def _push(self) -> None:
        """Push once, as the step says."""
        pushes, self._pushes = self._pushes, {}
        for push in pushes.items():
            self._link.requests.submit("push", partial(self._link.push, *push), self._note.fail)


def motion_text(peak_to_peak: float, period: float) -> str:
    """Size [rad] and, where there is one, period [s] of a motion."""
    return f"{peak_to_peak:.3f} rad" + (f", {period:.2f} s" if isfinite(period) else "")
