"""Controls for files: a bag that is recorded, parameter files out of and into the nodes."""

from datetime import datetime
from pathlib import Path
from typing import Any

import viser

from furuta_model.parameters import ParameterError
from furuta_recordings.recorder_node import RecorderNode
from furuta_ros.yaml_files import LARGEST_FILE
from furuta_sim.settings.settings import settings_from_text
from furuta_view.page_layout import Note
from furuta_view.parameters_on_page import ParametersOnPage


class FileControls:
    """Recording on and off, each in a new directory below ``directory``; *Save* and *Load*."""

    def __init__(self, gui: Any, parameters: ParametersOnPage, note: Note, directory: Path) -> None:
        self._parameters, self._note, self._directory = parameters, note, directory
        self._recorder: RecorderNode | None = None
        self._bag = directory
        self._wanted = False  # the recorder belongs to the thread that draws
        self._record = gui.add_checkbox("record a bag", False)
        self._record.on_update(lambda _: setattr(self, "_wanted", self._record.value))
        save = gui.add_button("Save parameters", icon=viser.Icon.DOWNLOAD)
        save.on_click(self._save)
        load = gui.add_upload_button("Load parameters", icon=viser.Icon.UPLOAD)
        load.on_upload(lambda event: self._load(event.target.value))

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

    def _save(self, event: Any) -> None:
        event.client.send_file_download("furuta.yaml", self._parameters.file().encode())

    def _load(self, file: Any) -> None:
        try:
            if len(file.content) > LARGEST_FILE:
                raise ParameterError(f"{file.name} is larger than {LARGEST_FILE} bytes")
            settings = settings_from_text(file.content.decode(), file.name)
        except (ParameterError, UnicodeDecodeError) as error:
            self._note.fail(str(error))
            return
        self._note.tell(f"loaded {file.name}")
        self._parameters.load(settings, self._note.fail)
