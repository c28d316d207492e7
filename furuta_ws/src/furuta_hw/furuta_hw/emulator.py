"""Executable ``rig_emulator``: a rig in software on a pseudo-terminal, in a process of its own.

In real time a sample is due at every period of the steady clock; where the process comes late the
rig moves on as a real one would, with the voltage in force and the watchdog running. In lock-step
a driven rig waits for the answer to each sample, as fast or as slow as it comes.
"""

from __future__ import annotations

import argparse
import gc
import os
import select
import signal
import sys
import tty
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from time import monotonic_ns, sleep
from typing import Any

import yaml

from furuta_hw.emulated import EmulatedRig, simulated
from furuta_hw.faults import Faults, with_faults
from furuta_hw.monitor import serve
from furuta_hw.rig import Rig
from furuta_hw.rig_file import load_rig
from furuta_hw.trace import Trace
from furuta_model.parameters import ParameterError, build, declared
from furuta_sim.parameters import InitialState

# Later than this by [ns] the process was suspended, not late: the rig's time stood still too.
SUSPENDED = 1_000_000_000
# Of the real-time scheduler; any will do before those without.
PRIORITY = 10
# Longest wait for the answer to a sample in lock-step [s].
PATIENCE = 1.0


class Terminal:
    """The rig's end of a pseudo-terminal."""

    def __init__(self) -> None:
        # This process keeps the other end open too: without any opener, reading would fail.
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.name = os.ttyname(self._slave)

    def read(self, wait: float = 0.0) -> bytes:
        """What has come, after a wait of at most ``wait`` [s]."""
        if wait > 0.0:
            select.select([self._master], [], [], wait)
        try:
            return os.read(self._master, 65536)
        except BlockingIOError:
            return b""

    def write(self, data: bytes) -> None:
        """Send; what finds no room is lost, as on a wire that nobody reads."""
        try:
            os.write(self._master, data)
        except BlockingIOError:
            return


class Emulator:
    """An emulated rig, its terminal, and what an observer may ask of it."""

    def __init__(self, rig: EmulatedRig, period: float) -> None:
        self.rig = rig
        self.terminal = Terminal()
        self.trace = Trace()
        self._period = round(period * 1e9)
        self.late = 0  # samples that the process came too late for

    def run(self, stop: Callable[[], bool], lockstep: bool) -> None:
        """Live until ``stop()``."""
        (self._lockstep if lockstep else self._realtime)(stop)

    def _realtime(self, stop: Callable[[], bool]) -> None:
        _take_priority()
        due = monotonic_ns() + self._period
        while not stop():
            sleep(max(0, due - monotonic_ns()) * 1e-9)
            if monotonic_ns() - due > SUSPENDED:
                due = monotonic_ns()
            self.rig.receive(self.terminal.read())
            out = self._sample(due)
            due += self._period
            while due <= monotonic_ns():
                self.late += 1
                out += self._sample(due)
                due += self._period
            self.terminal.write(out)

    def _lockstep(self, stop: Callable[[], bool]) -> None:
        rig, firmware = self.rig, self.rig.firmware
        while not stop():
            self.rig.receive(self.terminal.read())
            self.terminal.write(self._sample(monotonic_ns()))
            patience = monotonic_ns() + round(PATIENCE * 1e9)
            while firmware.armed and firmware.answered != firmware.number and not stop():
                rig.receive(self.terminal.read(0.01))
                rig.take()
                if monotonic_ns() > patience:
                    break
            if not firmware.armed:
                sleep(self._period * 1e-9)

    def _sample(self, due: int) -> bytes:
        rig = self.rig
        out = rig.tick()
        self.trace.add(due, rig.x, rig.volts, rig.firmware.armed, rig.firmware.number)
        return out

    def answer(self, request: dict[str, Any]) -> dict[str, Any]:
        """Answer an observer: status, faults NAME=VALUE, hold, reboot, save path."""
        do = request.pop("do", None)
        if do == "status":
            return self._status()
        if do == "faults":
            self.rig.faults = with_faults(self.rig.faults, request)
            return self.rig.faults._asdict()
        if do == "hold":
            self.rig.hold()
            return self._status()
        if do == "reboot":
            self.rig.firmware.reboot()
            return self._status()
        if do == "save":
            return {"rows": self.trace.save(Path(request["path"]))}
        raise ValueError(f"do must be one of status, faults, hold, reboot, save, given {do!r}")

    def _status(self) -> dict[str, Any]:
        rig = self.rig
        return {
            "volts": rig.volts,
            "armed": rig.firmware.armed,
            "tripped": rig.firmware.tripped,
            "held": rig.held,
            "sample": rig.firmware.number,
            "answered": rig.firmware.answered,
            "driven": rig.firmware.driven,
            "discarded": rig.firmware.discarded,
            "late": self.late,
            "state": [float(each) for each in rig.x[:4]],
        }


def _arguments(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="rig_emulator", description=__doc__)
    parser.add_argument("--rig", type=Path, help="rig file; default: the paper's rig")
    parser.add_argument("--link", type=Path, help="make a link to the port's name here")
    parser.add_argument("--monitor", type=Path, help="Unix socket to look in and inject faults")
    parser.add_argument("--lockstep", action="store_true", help="wait for each answer when driven")
    parser.add_argument("--seed", type=int, default=0, help="seed of the sensors' noise")
    parser.add_argument("--initial", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--fault", action="append", default=[], metavar="NAME=VALUE")
    # ros2 run and ros2 launch add arguments of ROS, which mean nothing here.
    return parser.parse_known_args(arguments)[0]


def _values(assignments: list[str]) -> dict[str, Any]:
    pairs = [each.partition("=") for each in assignments]
    if any(not separator for _, separator, _ in pairs):
        raise ParameterError(f"expected NAME=VALUE, given {', '.join(assignments)}")
    return {name: yaml.safe_load(text) for name, _, text in pairs}


def _initial(assignments: list[str]) -> InitialState:
    given = _values(assignments)
    known = [each.name for each in declared(InitialState)]
    for name in given:
        if name not in known:
            raise ParameterError(f"no state {name}; states are {', '.join(known)}")
    return build(InitialState, given)


def _take_priority() -> None:
    """Run before others where the system permits: no load of the host slows a rig."""
    with suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))


def _stop() -> Callable[[], bool]:
    asked: list[int] = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, _: asked.append(number))
    return lambda: bool(asked)


def main() -> None:
    """Entry point of the executable ``rig_emulator``."""
    options = _arguments(None)
    stop = _stop()
    try:
        rig = load_rig(options.rig) if options.rig else Rig()
        plant = simulated(rig, _initial(options.initial), options.seed)
        faults = with_faults(Faults(), _values(options.fault))
        emulator = Emulator(EmulatedRig(rig, plant, faults), rig.line.sample_time)
        if options.monitor:
            serve(options.monitor, emulator.answer)
        if options.link:
            options.link.unlink(missing_ok=True)
            options.link.symlink_to(emulator.terminal.name)
    except (ParameterError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(1)
    print(f"port: {emulator.terminal.name}", flush=True)
    gc.collect()
    gc.freeze()
    emulator.run(stop, options.lockstep)
    for path in (options.link, options.monitor):
        if path:
            path.unlink(missing_ok=True)
