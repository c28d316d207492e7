"""A port to an emulated rig in this process, as the rig drivers use it."""

from __future__ import annotations

from time import monotonic, sleep

from furuta_hw.rigs.rig import Rig
from furuta_sim.emulator.emulated_rig import EmulatedRig


class MockPort:
    """An emulated rig in this process. Its time runs while it is read."""

    def __init__(self, rig: Rig) -> None:
        self._rig = EmulatedRig(rig)
        self._period = rig.line.sample_time
        self._next = monotonic() + self._period

    def read(self) -> bytes:
        """Wait until the next sample is due, and return its bytes."""
        sleep(max(0.0, self._next - monotonic()))
        self._next = max(self._next + self._period, monotonic())
        return self._rig.step()

    def write(self, data: bytes) -> None:
        """Send to the rig."""
        self._rig.receive(data)

    def close(self) -> None:
        """Do nothing: there is nothing to free."""
