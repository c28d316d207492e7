"""The control for recording a bag."""

from datetime import datetime
from pathlib import Path
from typing import Any

from furuta_model.parameters import ParameterError
from furuta_recordings.recorder_node import RecorderNode
from furuta_view.page_layout import Note
from furuta_view.parameters_on_page import ParametersOnPage


class RecordingControl:
    """Recording on and off, each in a new directory below ``directory``."""

    def __init__(self, gui: Any, parameters: ParametersOnPage, note: Note, directory: Path) -> None:
        self._parameters, self._note, self._directory = parameters, note, directory
        self._recorder: RecorderNode | None = None
        self._bag = directory
        self._wanted = False  # the recorder belongs to the thread that draws
        self._record = gui.add_checkbox("record a bag", False)
        self._record.on_update(lambda _: setattr(self, "_wanted", self._record.value))

    def update(self, lockstep: bool) -> None:
        """Start or end the recording as the user wishes, and collect; called 30 times a second."""
        if self._wanted and self._recorder is None:
            self._start(lockstep)
        elif not self._wanted:
            self.stop()
        if self._recorder is not None:
            self._recorder.collect()

    def stop(self) -> None:
        """End the bag, if there is one."""
        if self._recorder is None:
            return
        recorder, self._recorder = self._recorder, None
        recorder.destroy_node()
        self._note.tell(recorder.failure or f"{recorder.kept} messages in {self._bag}")

    def _start(self, lockstep: bool) -> None:
        self._bag = self._directory / f"view-{datetime.now():%Y%m%d-%H%M%S}"
        try:
            self._directory.mkdir(parents=True, exist_ok=True)
            parameters = self._parameters.file()
            self._recorder = RecorderNode(self._bag, lockstep, parameters=parameters)
            self._note.tell(f"recording into {self._bag}")
        except (OSError, ParameterError) as error:
            self._record.value = self._wanted = False
            self._note.fail(f"cannot record: {error}")
