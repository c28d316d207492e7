"""From an unknown rig to a pendulum that stands, by the commands of docs/identification.md.

    tools/in_environment python benchmarks/rigs_by_commands.py --rigs 10

Each rig is random and emulated in real time by a process of its own. Its pendulum hangs; it is
driven, recorded, identified and checked. The rig file that was written then balances it, with
compensation. All that the commands know before is a base file: sensors, drive, line and limits.
"""

import json
import os
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from rigs_from_recordings import KNOWN, chosen_seeds, random_rig

from furuta_graph.processes import executable
from furuta_hw.rigs.rig_file import rig_file_text
from furuta_hw.rigs.uncertainty import Uncertainty
from furuta_sim.emulator.monitor import ask

SECONDS = 20.0  # of the recording, and of the balanced run
EXCITATION = {"kind": "multisine", "amplitude": 1.0, "period": 4.0}
LIMITS = {"speed_limit": 40.0, "excursion_limit": 100.0}
RECORDINGS = 3  # at most
ARMED = 0.75  # part of the balanced run that must have been armed: arming takes a while
UPRIGHT = 0.5  # [rad] of the pendulum, which must never be exceeded
NO_UNCERTAINTY = Uncertainty((), np.zeros((0, 0)))
DOMAIN = "71"  # ROS_DOMAIN_ID of the graphs


class CommandError(Exception):
    """A command failed; the message is what it wrote."""


class Commands:
    """The commands for one rig, in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        self.port, self.monitor = folder / "port", folder / "monitor"
        self._environment = os.environ | {"ROS_DOMAIN_ID": DOMAIN}

    def furuta(self, *arguments: object) -> str:
        """Run ``furuta ARGUMENTS`` to its end; returns what it wrote."""
        return _rest(self._start(*arguments), "")

    def shown(self, *arguments: object) -> dict[str, Any]:
        """What ``furuta ARGUMENTS --json`` prints, whatever its status."""
        process = self._start(*arguments, "--json", errors=subprocess.DEVNULL)
        answer: dict[str, Any] = json.loads(process.communicate()[0])
        return answer

    @contextmanager
    def emulated(self, rig: Path) -> Iterator[None]:
        """An emulated rig whose pendulum hangs."""
        options = ("--rig", rig, "--link", self.port, "--monitor", self.monitor)
        process = self._start("hw", "emulate", *options, "--initial", "theta=3.13")
        try:
            _read_until(process, "port: ")
            yield
        finally:
            process.send_signal(signal.SIGINT)
            process.communicate()

    def drive(self, *arguments: object) -> None:
        """Run the graph on the rig, arm it, and wait for the end of the run."""
        options = ("--plant", "hardware", "--port", self.port, "--seconds", SECONDS)
        run = self._start("run", *options, *arguments)
        text = _read_until(run, "active, not armed")
        self.furuta("hw", "arm")
        _rest(run, text)

    def _start(self, *arguments: object, errors: int = subprocess.STDOUT) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [executable("furuta_bringup", "furuta"), *map(str, arguments)],
            env=self._environment,
            stdout=subprocess.PIPE,
            stderr=errors,
            text=True,
        )


def _read_until(process: subprocess.Popen[str], expected: str) -> str:
    """Read lines until one has this text; returns them."""
    assert process.stdout is not None
    text = ""
    for line in process.stdout:
        text += line
        if expected in line:
            return text
    raise CommandError(text)


def _rest(process: subprocess.Popen[str], before: str) -> str:
    """Wait for the end of a command; returns what it wrote."""
    text = before + process.communicate()[0]
    if process.returncode:
        raise CommandError(text)
    return text


def study(seed: int, folder: Path) -> tuple[bool, str]:
    """Whether a random rig is held upright in the end, and the result in words."""
    commands = Commands(folder)
    base, truth, identified = (folder / f"{name}.yaml" for name in ("base", "truth", "my_rig"))
    for file, rig in ((base, KNOWN), (truth, random_rig(seed))):
        file.write_text(rig_file_text(rig, NO_UNCERTAINTY, file.stem), encoding="utf-8")
    with commands.emulated(truth):
        recordings = _identify(commands, base, identified)
        ask(commands.monitor, "hold", theta=0.0)
        commands.drive("--rig", identified, "--set", "compensation=combined")
        log = folder / "log.npz"
        ask(commands.monitor, "save", path=str(log))
    phi, theta = _last_run(log)
    armed = len(phi) * KNOWN.line.sample_time
    stands = armed > ARMED * SECONDS and float(np.max(np.abs(theta))) < UPRIGHT
    arm = 1e3 * float(np.ptp(phi[len(phi) // 2 :]))
    text = f"{arm:.1f} mrad peak to peak, armed for {armed:.1f} s, after {recordings} recordings"
    return stands, text


def _identify(commands: Commands, base: Path, identified: Path) -> int:
    """Record, identify and check until a compensation holds; returns the number of recordings.

    The signal is that of docs/identification.md.
    """
    recordings: list[Path] = []
    while True:
        recordings.append(identified.with_name(f"hanging_{len(recordings)}"))
        ask(commands.monitor, "hold", theta=3.13)
        commands.drive("--rig", base, "--record", recordings[-1], *_options(EXCITATION | LIMITS))
        options = ("--command", "effort", "--rig", base, "--window", 1, "--write", identified)
        identified.unlink(missing_ok=True)
        commands.furuta("identify", *recordings, *options)
        if commands.shown("compare", "--rig", identified)["recommended"] is not None:
            return len(recordings)
        if len(recordings) == RECORDINGS:
            raise CommandError(f"no compensation holds after {RECORDINGS} recordings")


def _options(excitation: dict[str, Any]) -> list[str]:
    settings = {f"excitation.{name}": value for name, value in excitation.items()}
    settings |= {"mode": "open_loop"}
    pairs = [f"controller.{name}={value}" for name, value in settings.items()]
    return [part for pair in [*pairs, "compensation=none"] for part in ("--set", pair)]


def _last_run(log: Path) -> tuple[np.ndarray, np.ndarray]:
    """φ and θ [rad] while the rig was armed for the last time."""
    with np.load(log) as columns:
        armed = np.flatnonzero(columns["armed"])
        first = armed[np.flatnonzero(np.diff(armed, prepend=-2) > 1)[-1]]
        last = armed[-1] + 1
        return columns["phi"][first:last], columns["theta"][first:last]


def main() -> None:
    """Run the study and print a line for each rig."""
    stood, seeds = 0, chosen_seeds(__doc__)
    for seed in seeds:
        with TemporaryDirectory() as folder:
            try:
                stands, text = study(seed, Path(folder))
            except CommandError as error:
                stands, text = False, str(error)
        stood += stands
        print(f"rig {seed} {'stands' if stands else 'fell'}: {text}", flush=True)
    print(f"{stood} of {len(seeds)} rigs stand")


if __name__ == "__main__":
    main()
