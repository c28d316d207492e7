"""Executable ``rig_emulator``: an emulated rig on a pseudo-terminal, in a process of its own.

In real time a sample is due at every period of the steady clock. If the process is late, the rig
continues as a real one would, with the voltage last applied and its watchdog running. In lock-step
a driven rig waits for the answer to each sample.
"""

import argparse
import gc
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

from furuta_hw.emulator.compiled_firmware import CompiledFirmware
from furuta_hw.emulator.emulated_rig import EmulatedRig, initial_state_of, plant_of
from furuta_hw.emulator.faults import Faults, with_faults
from furuta_hw.emulator.firmware import Firmware
from furuta_hw.emulator.running_rig import RunningRig, serve
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.rig_file import load_rig
from furuta_model.parameters import ParameterError
from furuta_ros.process import INTERRUPTED, StopSignal, own_arguments
from furuta_ros.yaml_files import parse_yaml

# Priority in the real-time scheduler. Any value precedes processes without real-time priority.
PRIORITY = 10


def main() -> None:
    """Entry point of the executable ``rig_emulator``."""
    options = _parse_arguments()
    stop = StopSignal()
    try:
        running = _make_rig(options)
        if options.monitor:
            serve(options.monitor, running.answer)
        if options.link:
            options.link.unlink(missing_ok=True)
            options.link.symlink_to(running.terminal.name)
    except (ParameterError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(1)
    if stop():
        sys.exit(INTERRUPTED)
    print(f"port: {running.terminal.name}", flush=True)
    gc.collect()
    gc.freeze()
    if options.lockstep:
        running.run_in_lockstep(stop)
    else:
        _raise_priority()
        running.run_in_real_time(stop)
    for path in (options.link, options.monitor):
        if path:
            path.unlink(missing_ok=True)


def _parse_arguments() -> argparse.Namespace:
    parser = _Parser(prog="rig_emulator", description=__doc__)
    parser.add_argument("--rig", type=Path, help="rig file; default: the paper's rig")
    parser.add_argument("--link", type=Path, help="make a link to the port, such as /tmp/rig")
    parser.add_argument("--monitor", type=Path, help="Unix socket for requests (docs/hardware.md)")
    parser.add_argument("--lockstep", action="store_true", help="wait for each answer while driven")
    parser.add_argument(
        "--firmware", action="store_true", help="run the C firmware instead of the rules in Python"
    )
    parser.add_argument(
        "--loop", type=Path, metavar="DIR", help="run this exported loop in the C firmware"
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of the sensors' noise")
    parser.add_argument(
        "--initial",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="initial state, such as theta=0.1; repeatable",
    )
    parser.add_argument(
        "--fault",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="fault to inject, such as lost=0.1; repeatable",
    )
    # ros2 run and ros2 launch add ROS arguments, which are ignored here.
    return parser.parse_args(own_arguments(sys.argv[1:]))


class _Parser(argparse.ArgumentParser):
    """Reports wrong usage in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"error: {message} (see {self.prog} --help)\n")


def _make_rig(options: argparse.Namespace) -> RunningRig:
    rig = load_rig(options.rig) if options.rig else Rig()
    plant = plant_of(rig, initial_state_of(_values(options.initial)), options.seed)
    faults = with_faults(Faults(), _values(options.fault))
    make_firmware: Callable[[int, int, int], Firmware] = Firmware
    if options.firmware or options.loop:
        make_firmware = partial(CompiledFirmware, loop=options.loop)
    return RunningRig(EmulatedRig(rig, plant, faults, make_firmware), rig.line.sample_time)


def _values(assignments: list[str]) -> dict[str, Any]:
    pairs = [assignment.partition("=") for assignment in assignments]
    if any(not separator for _, separator, _ in pairs):
        raise ParameterError(f"expected NAME=VALUE, given {', '.join(assignments)}")
    return {name: parse_yaml(text, name) for name, _, text in pairs}


def _raise_priority() -> None:
    """Run before other processes if the system permits it: no load slows a real rig."""
    with suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
