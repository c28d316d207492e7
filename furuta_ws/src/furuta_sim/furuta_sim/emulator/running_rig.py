"""Runs an emulated rig in real time or in lock-step, and answers its monitor."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from threading import Lock
from time import monotonic_ns, sleep
from typing import Any

from furuta_sim.emulator.emulated_rig import EmulatedRig, initial_state_of
from furuta_sim.emulator.emulator_log import EmulatorLog
from furuta_sim.emulator.faults import with_faults
from furuta_sim.emulator.pseudo_terminal import PseudoTerminal

# A delay above this [ns] means that the process was suspended: the rig's time stood still too.
SUSPENDED = 1_000_000_000
# Longest wait for the answer to a sample in lock-step [ns].
ANSWER_TIMEOUT = 1_000_000_000


class RunningRig:
    """An emulated rig with its pseudo-terminal and its log."""

    def __init__(self, rig: EmulatedRig, period: float) -> None:
        self.rig = rig
        self.terminal = PseudoTerminal()
        self.log = EmulatorLog()
        self._period = round(period * 1e9)
        self.late_samples = 0
        self._lock = Lock()  # the monitor reads on its own thread

    def run_in_real_time(self, stop: Callable[[], bool]) -> None:
        """Run until ``stop()``, with a sample at every period of the steady clock."""
        due = monotonic_ns() + self._period
        while not stop():
            sleep(max(0, due - monotonic_ns()) * 1e-9)
            if monotonic_ns() - due > SUSPENDED:
                due = monotonic_ns()
            self.rig.receive(self.terminal.read())
            out = self._sample(due)
            due += self._period
            while due <= monotonic_ns():
                self.late_samples += 1
                out += self._sample(due)
                due += self._period
            self.terminal.write(out)

    def run_in_lockstep(self, stop: Callable[[], bool]) -> None:
        """Run until ``stop()``. While the rig is driven it waits for the answer to each sample."""
        firmware = self.rig.firmware
        while not stop():
            self.rig.receive(self.terminal.read())
            self.terminal.write(self._sample(monotonic_ns()))
            self._wait_for_answer(stop)
            if not firmware.armed:
                sleep(self._period * 1e-9)

    def _wait_for_answer(self, stop: Callable[[], bool]) -> None:
        firmware = self.rig.firmware
        end = monotonic_ns() + ANSWER_TIMEOUT
        while firmware.armed and firmware.answered != firmware.number and not stop():
            self.rig.receive(self.terminal.read(0.01))
            with self._lock:
                self.rig.process_input()
            if monotonic_ns() > end:
                return

    def _sample(self, due: int) -> bytes:
        rig = self.rig
        with self._lock:
            out = rig.step()
        self.log.add(due, rig.x, rig.volts, rig.firmware.armed, rig.firmware.number)
        return out

    def answer(self, request: dict[str, Any]) -> dict[str, Any]:
        """Answer a request of the monitor: status, faults, hold, reboot, save.

        Faults have values by name, ``hold`` may have those of the initial state, ``save`` a path.
        """
        do = request.pop("do", None)
        if do == "save":
            return {"rows": self.log.save(Path(request["path"]))}
        with self._lock:
            return self._answer_at_once(do, request)

    def _answer_at_once(self, do: Any, request: dict[str, Any]) -> dict[str, Any]:
        if do == "faults":
            self.rig.faults = with_faults(self.rig.faults, request)
            return self.rig.faults._asdict()
        if do == "hold":
            self.rig.hold(initial_state_of(request) if request else None)
        elif do == "reboot":
            self.rig.firmware.reboot()
        elif do != "status":
            raise ValueError(f"do must be one of status, faults, hold, reboot, save, given {do!r}")
        return self._status()

    def _status(self) -> dict[str, Any]:
        rig = self.rig
        return {
            "volts": rig.drive_volts,
            "armed": rig.firmware.armed,
            "tripped": rig.firmware.tripped,
            "held": rig.held,
            "sample": rig.firmware.number,
            "answered": rig.firmware.answered,
            "driven": rig.firmware.driven,
            "discarded": rig.firmware.discarded,
            "late": self.late_samples,
            "state": [float(value) for value in rig.x[:4]],
        }
