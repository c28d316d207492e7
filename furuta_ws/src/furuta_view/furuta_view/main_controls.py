"""The main controls of the page: push, reset, pause, record, files, and arming of a rig."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from html import escape
from time import sleep
from typing import Any

import viser

from furuta_model.parameters import ParameterError
from furuta_sim.settings.nodes import PLANT
from furuta_sim.settings.settings import settings_from_text
from furuta_view.graph_link import GraphLink
from furuta_view.pacer import FASTEST, SPEEDS, Pacer
from furuta_view.page_recorder import PageRecorder
from furuta_view.parameters_on_page import ParametersOnPage

# A push: torque [V], and how long it lasts [s].
PUSH_TIME = 0.1
PUSHES = {"push arm": "pushes.arm", "push pendulum": "pushes.pendulum"}
LEFT, RIGHT = "− ←", "→ +"
# A push that has begun and does not end by itself.
BEGUN = {"pushes.times": [0.0], "pushes.durations": [1e6]}
LARGEST_PARAMETER_FILE = 2**21
# The bridge publishes its diagnostics once a second; older ones say nothing about now [s].
OLDEST_STATUS = 4.0
ALARM = "#b91c1c"


class Note:
    """A line under the controls that says what happened last."""

    def __init__(self, gui: Any, order: float) -> None:
        self._handle = gui.add_html("", visible=False, order=order)

    def tell(self, text: str, failed: bool = False) -> None:
        """Show a sentence, or nothing."""
        colour = "#b91c1c" if failed else "#334155"
        self._handle.content = (
            f'<div class="note" style="color:{colour};font-size:14px;padding:0 8px 6px">'
            f"{escape(text)}</div>"
        )
        self._handle.visible = bool(text)

    def fail(self, reason: str) -> None:
        """Show why something failed."""
        self.tell(reason, failed=True)


class SimulationControls:
    """Push and reset; in lock-step also pause and speed.

    When the page that has paused the plant is closed, the plant continues.
    """

    def __init__(self, server: Any, link: GraphLink, note: Note, pacer: Pacer) -> None:
        self._link, self._note, self.pacer = link, note, pacer
        gui = server.gui
        self._push_size = gui.add_slider("push size [V]", 0.1, 5.0, 0.1, 1.0)
        for label, parameter in PUSHES.items():
            gui.add_button_group(label, (LEFT, RIGHT)).on_click(partial(self._push, parameter))
        reset = gui.add_button("Reset: pendulum upright", icon=viser.Icon.RESTORE)
        reset.on_click(lambda _: link.requests.submit("reset", link.reset, note.fail))
        self._speed = gui.add_dropdown("speed", list(SPEEDS), initial_value=FASTEST, visible=False)
        self._speed.on_update(lambda _: setattr(pacer, "speed", SPEEDS[self._speed.value]))
        self._pause = gui.add_checkbox("pause", False, visible=False)
        self._pause.on_update(lambda event: self.set_paused(self._pause.value, event.client))
        self._paused_by: int | None = None
        server.on_client_disconnect(self.client_gone)

    def show_pacing(self, lockstep: bool) -> None:
        """Show pause and speed in lock-step only."""
        if self._pause.visible != lockstep:
            self._pause.visible = self._speed.visible = lockstep

    def set_paused(self, paused: bool, client: Any) -> None:
        """Pause or continue, as a client wishes."""
        self.pacer.paused = paused
        self._paused_by = client.client_id if client and paused else None

    def client_gone(self, client: Any) -> None:
        """Continue if this client has paused the plant."""
        if client.client_id == self._paused_by:
            self.set_paused(False, None)
            self._pause.value = False

    def _push(self, parameter: str, event: Any) -> None:
        size = self._push_size.value * (1.0 if event.target.value == RIGHT else -1.0)
        work = partial(self._push_now, parameter, size)
        self._link.requests.submit("push", work, self._note.fail)

    def _push_now(self, parameter: str, size: float) -> None:
        """Push by parameters: begin a push without end, and end it after a while."""
        names = [*BEGUN, "pushes.arm", "pushes.pendulum", "pushes.base_x", "pushes.base_y"]
        before = self._link.get(PLANT, names)
        try:
            none = {name: [0.0] for name in names if name not in BEGUN}
            self._link.set(PLANT, none | BEGUN | {parameter: [size]})
            sleep(PUSH_TIME)
        finally:
            self._link.set(PLANT, {name: list(value) for name, value in before.items()})


class FileControls:
    """Recording on and off; parameter files out of and into the nodes."""

    def __init__(
        self, gui: Any, parameters: ParametersOnPage, note: Note, recorder: PageRecorder
    ) -> None:
        self._parameters, self._note = parameters, note
        self.recorder = recorder
        self.wish_to_record = False
        self.record = gui.add_checkbox("record a bag", False)
        self.record.on_update(lambda _: setattr(self, "wish_to_record", self.record.value))
        save = gui.add_button("Save parameters", icon=viser.Icon.DOWNLOAD)
        save.on_click(self._save)
        load = gui.add_upload_button("Load parameters", icon=viser.Icon.UPLOAD)
        load.on_upload(lambda event: self._load(event.target.value))

    def update(self, lockstep: bool) -> None:
        """Start or end the recording as the user wishes, and collect; called 30 times a second."""
        if self.wish_to_record and not self.recorder.is_recording:
            self._start(lockstep)
        elif not self.wish_to_record and self.recorder.is_recording:
            self._note.tell(self.recorder.stop())
        self.recorder.collect()

    def _start(self, lockstep: bool) -> None:
        try:
            self.recorder.start(lockstep, self._parameters.file())
            self._note.tell(f"recording into {self.recorder.directory}")
        except (OSError, ParameterError) as error:
            self.record.value = self.wish_to_record = False
            self._note.fail(f"cannot record: {error}")

    def _save(self, event: Any) -> None:
        event.client.send_file_download("furuta.yaml", self._parameters.file().encode())

    def _load(self, file: Any) -> None:
        try:
            if len(file.content) > LARGEST_PARAMETER_FILE:
                raise ParameterError(f"{file.name} is larger than {LARGEST_PARAMETER_FILE} bytes")
            settings = settings_from_text(file.content.decode(), file.name)
        except (ParameterError, UnicodeDecodeError) as error:
            self._note.fail(str(error))
            return
        self._note.tell(f"loaded {file.name}")
        self._parameters.load(settings, self._note.fail)


class RigControls:
    """Arm and disarm, and what the bridge says, in a panel of their own that is always in sight.

    A narrow page shows one panel at a time. So the main panel begins with the status and *Disarm*.
    """

    def __init__(self, server: Any, link: GraphLink) -> None:
        gui = server.gui
        self._in_main = gui.add_html("", order=-2.0)
        stop = gui.add_button("Disarm", color="red", icon=viser.Icon.HAND_STOP, order=-1.0)
        stop.on_click(self._caller(link, False))
        panel = gui.add_panel(order=-1.0)
        with panel.add_tab("Rig"):
            self._status = gui.add_html("")
            disarm = gui.add_button("Disarm: 0 V", color="red", icon=viser.Icon.HAND_STOP)
            arm = gui.add_button("Arm", color="green", icon=viser.Icon.PLAYER_PLAY)
            self._note = Note(gui, 9.0)
        panel.dock_above(gui.main_panel)
        disarm.on_click(self._caller(link, False))
        arm.on_click(self._caller(link, True))

    def _caller(self, link: GraphLink, armed: bool) -> Callable[[Any], None]:
        def call(_: Any) -> None:
            self._note.tell("")
            link.arming.submit("arm", partial(link.arm, armed), self._note.fail)

        return call

    def show(self, status: Any, age: float) -> None:
        """Show the newest diagnostics of the bridge and their age [s], or that there are none."""
        if status is not None and age > OLDEST_STATUS:
            self._tell("unknown", ALARM, f"the bridge has been silent for {age:.0f} s")
            return
        values = {each.key: each.value for each in status.values} if status else {}
        armed = values.get("armed") == "True"
        text = status.message if status else "no diagnostics from the bridge"
        title, colour = ("ARMED", "#b45309") if armed else ("not armed", "#334155")
        below = f"{values['state']}, stops: {values.get('stops', '0')}" if "state" in values else ""
        self._tell(title, colour, text, below)

    @property
    def text(self) -> str:
        """What is shown, as HTML."""
        return str(self._status.content)

    def _tell(self, title: str, colour: str, text: str, below: str = "") -> None:
        content = (
            f'<div class="rig" style="padding:2px 8px;font-size:16px"><b style="color:{colour}">'
            f"{escape(title)}</b>: {escape(text)}<br>{escape(below)}</div>"
        )
        if self._status.content != content:
            self._status.content = self._in_main.content = content
