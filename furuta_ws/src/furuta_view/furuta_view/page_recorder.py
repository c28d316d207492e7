"""Records a bag while the page is open, switched on and off by the user."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path

from furuta_recordings.recorder_node import RecorderNode


class PageRecorder:
    """At most one recording at a time, each in a new directory below ``parent``."""

    def __init__(self, parent: Path) -> None:
        self._parent = parent
        self._node: RecorderNode | None = None
        self.directory = Path()

    @property
    def is_recording(self) -> bool:
        """Whether a bag is being written."""
        return self._node is not None

    def start(self, stamped: bool, parameters: str) -> None:
        """Begin a bag; ``stamped`` in lock-step. Raises ParameterError if it cannot be made."""
        self.directory = self._parent / f"view-{datetime.now():%Y%m%d-%H%M%S}"
        self._parent.mkdir(parents=True, exist_ok=True)
        self._node = RecorderNode(self.directory, stamped, parameters=parameters)

    def collect(self) -> None:
        """Pass what has arrived to the writer."""
        if self._node is not None:
            self._node.collect()

    def stop(self) -> str:
        """End the bag; returns a sentence about it."""
        if self._node is None:
            return ""
        node, self._node = self._node, None
        node.destroy_node()
        return node.failure or f"{node.kept} messages in {self.directory}"
