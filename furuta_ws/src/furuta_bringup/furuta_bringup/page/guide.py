"""The guided scenes: a scene to choose, its text, and what its steps have measured."""

from collections.abc import Callable
from functools import partial
from html import escape
from typing import Any

import numpy as np

from furuta_bringup.page.figures import Elapsed, figures, measuring, swing
from furuta_bringup.page.graph_link import GraphLink
from furuta_bringup.page.guided_scenes import (
    MEASURED,
    Values,
    guided_steps,
    names_of,
    step_values,
    values_of,
)
from furuta_bringup.page.page_layout import Note, table_html
from furuta_bringup.page.samples import TIME

FREE = "free play"
BACK, NEXT = "back", "next"
HINT = "five guided scenes; free play restores the parameters that they change"
COLUMN = '<div style="margin-top:4px;text-align:right;color:#475569">arm, peak to peak</div>'
COMPUTING = "computing …"
LOOK = "3px solid #0072B2"


class Guide:
    """Leads through the scenes; in free play the parameters are as they were before.

    ``position`` is that of the step, None in free play, and ``elapsed`` the time since it began or
    something changed. ``values`` gives the parameters of the nodes, and ``pace`` sets whether time
    is real. Where a node or parameter is missing, as on a rig, there are no scenes.
    """

    def __init__(
        self, gui: Any, link: GraphLink, values: Callable[[], Values], pace: Callable[[bool], None]
    ) -> None:
        self._link, self._values, self._pace = link, values, pace
        self._steps = guided_steps()
        self._names = names_of(self._steps)
        self._scenes = [step.scene for step in self._steps]
        self.position: int | None = None
        self.elapsed = Elapsed()
        self._before: dict[str, Any] | None = None
        self._fallen = False
        self._measured: dict[int, str] = {}
        self._predicted: list[tuple[str, str]] = []
        self._pushes: dict[str, float] = {}
        self._folder = gui.add_folder(None, order=1.0, visible=False)
        with self._folder:
            names = dict.fromkeys(scene.name for scene in self._scenes)
            self._choice = gui.add_dropdown("scene", [FREE, *names], hint=HINT)
            self._buttons = gui.add_button_group("step", (BACK, NEXT, FREE), visible=False)
            self._shown = gui.add_html("", visible=False)
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
        self._predicted = predicted
        self._folder.visible = values_of(self._names, self._values()) is not None
        if self.position is not None and not self._link.requests.pending("scene"):
            self._show(self._measure(self.position, samples, fallen))

    def _measure(self, position: int, samples: np.ndarray, fallen: bool) -> str:
        """Keep what the step has measured; how long it takes until it has."""
        passed = self.elapsed.passed(samples[:, TIME])
        if passed > MEASURED.push_after:
            self._push()
        self._measured.pop(position, None)
        if fallen:
            self.elapsed.restart()  # what is measured after a fall begins when it has ended
            self._measured[position] = "fallen"
        elif wait := measuring(passed, MEASURED.settled):
            return wait
        else:
            self._measured[position] = swing(figures(samples, 0).phi_peak_to_peak)
        return ""

    def _show(self, wait: str) -> None:
        """The text of the scene, its steps and what they have measured."""
        if self.position is None:
            return
        step = self._steps[self.position]
        here = [place for place, scene in enumerate(self._scenes) if scene == step.scene]
        running = here.index(self.position)
        rows = [(self._steps[place].name, self._measured.get(place, "")) for place in here]
        rows[running] = step.name, wait or rows[running][1]
        predicted = self._predicted if step.scene.predict else []
        self._shown.content = (
            '<div class="scene" style="padding:0 10px 4px;font-size:13px;line-height:1.35">'
            f'<b style="font-size:15px">{escape(step.scene.title)}</b>'
            f'<p style="margin:0">{escape(step.scene.text)}</p>'
            f"{table_html(COLUMN, [*rows, *predicted], running)}"
            f'<p role="status" style="margin:4px 0;padding-left:7px;border-left:{LOOK}">'
            f"<b>{escape(step.name)}.</b> {escape(step.look)}</p></div>"
        )

    def _chosen(self, event: Any) -> None:
        """Begin the scene that a user has chosen."""
        if event.client is not None:
            names = [scene.name for scene in self._scenes]
            chosen = self._choice.value
            self._go(names.index(chosen) if chosen in names else None)

    def _pressed(self, button: str) -> None:
        """One step further or back; after the last one comes free play."""
        steps = range(len(self._steps))
        position = (self.position or 0) + {BACK: -1, NEXT: 1}.get(button, len(steps))
        self._go(position if position in steps else None)

    def _go(self, position: int | None) -> None:
        self.position, self._pushes = position, {}
        for handle in (self._buttons, self._shown):
            handle.visible = position is not None
        self._choice.value = FREE if position is None else self._scenes[position].name
        if position is not None:
            self._measured.pop(position, None)
        self._predicted = [(name, COMPUTING) for name, _ in self._predicted]
        self._show(measuring(0.0, MEASURED.settled))
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
        self._link.set_values(new, last_first=step is not None)
        if self._fallen:
            self._link.reset()
            self._fallen = False
        self.elapsed.restart()
        if step is None:
            self._before = None
            self._pace(False)
        self._pushes = dict(step.push) if step else {}

    def _push(self) -> None:
        """Push once, as the step says."""
        pushes, self._pushes = self._pushes, {}
        for push in pushes.items():
            self._link.requests.submit("push", partial(self._link.push, *push), self._note.fail)
