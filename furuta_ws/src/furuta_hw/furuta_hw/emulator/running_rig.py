"""Runs an emulated rig on a pseudo-terminal, logs it, and answers its monitor.

The monitor is a Unix socket with one JSON object per line in each direction. It does not use the
line to the bridge, so its report of the drive is independent of the bridge.
"""

import json
import os
import select
import socket
import tty
from collections.abc import Callable
from pathlib import Path
from threading import Lock, Thread
from time import monotonic_ns, sleep
from typing import Any

import numpy as np

from furuta_hw.connection.rig_connection import RETRY_PERIOD
from furuta_hw.emulator.emulated_rig import EmulatedRig, initial_state_of
from furuta_hw.emulator.faults import with_faults
from furuta_ros.whole_files import whole_file

# A delay above this [ns] means that the process was suspended: the rig's time stood still too.
SUSPENDED = 1_000_000_000
# Longest wait for the answer to a sample in lock-step [ns]: the host restarts a rig that is silent
# for longer.
ANSWER_TIMEOUT = round(0.5e9 * RETRY_PERIOD)
# Samples that the log keeps, the newest ones: ten minutes of 1 kHz, 43 MB.
KEPT = 600_000
# Columns of the log: when the sample was due (steady clock), the state after ``volts`` [V] over it.
# ``answered`` is the sample of the newest command or arming.
COLUMNS = (
    *("time_ns", "phi", "phi_dot", "theta", "theta_dot"),
    *("volts", "armed", "sample", "answered"),
)


class PseudoTerminal:
    """A pseudo-terminal; the host opens ``name`` like a serial port."""

    def __init__(self) -> None:
        # This process keeps the other end open too: reads fail while it is closed.
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.name = os.ttyname(self._slave)

    def read(self, wait: float = 0.0) -> bytes:
        """Return the received bytes, after a wait of at most ``wait`` [s]."""
        if wait > 0.0:
            select.select([self._master], [], [], wait)
        try:
            return os.read(self._master, 65536)
        except BlockingIOError:
            return b""

    def write(self, data: bytes) -> None:
        """Send; bytes are lost if the buffer is full, as on a serial line without a reader."""
        try:
            os.write(self._master, data)
        except BlockingIOError:
            return


class RunningRig:
    """An emulated rig with its pseudo-terminal and its log."""

    def __init__(self, rig: EmulatedRig, period: float) -> None:
        self.rig = rig
        self.terminal = PseudoTerminal()
        self._log, self._logged = np.zeros((KEPT, len(COLUMNS))), 0
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
            firmware = rig.firmware
            row = due, *rig.x[:4], rig.volts, firmware.armed, firmware.number, firmware.answered
            self._log[self._logged % KEPT] = row
            self._logged += 1
        return out

    def _save(self, path: Path) -> int:
        """Write the log, a row per sample, to an ``.npz`` file; returns the number of rows."""
        with self._lock:
            newest = self._logged % KEPT
            oldest = self._log[newest:] if self._logged >= KEPT else self._log[:0]
            table = np.concatenate((oldest, self._log[:newest]))
        columns: dict[str, Any] = dict(zip(COLUMNS, table.T, strict=True))
        with whole_file(path) as new:
            np.savez(new, **columns)
        return len(table)

    def answer(self, request: dict[str, Any]) -> dict[str, Any]:
        """Answer a request of the monitor: status, faults, hold, reboot, save.

        Faults have values by name, ``hold`` may have those of the initial state, ``save`` a path.
        """
        do = request.pop("do", None)
        if do == "save":
            return {"rows": self._save(Path(request["path"]))}
        with self._lock:
            return self._answer_at_once(do, request)

    def _answer_at_once(self, do: object, request: dict[str, Any]) -> dict[str, Any]:
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


def serve(path: Path, answer: Callable[[dict[str, Any]], dict[str, Any]]) -> None:
    """Answer requests at ``path`` on a thread until the process ends."""
    path.unlink(missing_ok=True)
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    listener.bind(str(path))
    listener.listen()

    def accept() -> None:
        while True:
            connection, _ = listener.accept()
            with connection, connection.makefile("rw") as lines:
                for line in lines:
                    try:
                        reply = answer(json.loads(line))
                    except (ValueError, TypeError, OSError) as error:
                        reply = {"error": str(error)}
                    lines.write(json.dumps(reply) + "\n")
                    lines.flush()

    Thread(target=accept, name="monitor", daemon=True).start()
