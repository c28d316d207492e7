"""Running the product as a user does: executables of the install space, and verbs."""

import json
import logging
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from math import inf
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import click
import numpy as np
import pytest

from furuta.settings.nodes import NODES
from furuta_bringup import main
from furuta_bringup.graph.processes import executable
from furuta_bringup.graph.services import ATTEMPTS, ServiceCaller
from furuta_model.compiled import NOTICE

TIMEOUT = 240.0
ANSWER_TIMEOUT = 10.0
WIDTH = "200"  # of the terminal [characters]
GRACE = 60.0
STATUS_AGE = 0.05


def commands(group: click.Group, *names: str) -> Iterator[tuple[tuple[str, ...], click.Command]]:
    """A group and all commands below it, with what one types for them."""
    yield names, group
    for name in group.list_commands(click.Context(group)):
        each = group.get_command(click.Context(group), name)
        assert each is not None
        if isinstance(each, click.Group):
            yield from commands(each, *names, name)
        else:
            yield (*names, name), each


class Processes:
    """Processes that end with the test."""

    def __init__(self) -> None:
        self._all: list[subprocess.Popen[str]] = []

    def node(self, name: str, *arguments: str) -> subprocess.Popen[str]:
        """Start a node by its executable with ROS arguments ``name:=value``."""
        ros = [part for argument in arguments for part in ("-p", argument)]
        about = NODES[name]
        command = executable(about.package, about.executable)
        return self.start(command, *(["--ros-args", *ros] if ros else []))

    def ready_node(self, name: str, *arguments: str) -> subprocess.Popen[str]:
        """Start a node and wait until it says that it is ready."""
        process = self.node(name, *arguments)
        wait_until_ready(process, 1)
        return process

    def furuta(self, *arguments: str | Path) -> subprocess.Popen[str]:
        """Start a verb of the command line."""
        return self.start(executable("furuta_bringup", "furuta"), *arguments)

    def run(self, *arguments: str | Path) -> tuple[int, str, str]:
        """Run a verb to its end: exit status, standard output, standard error.

        Without the notice of a first run: colcon test compiles as it goes.
        """
        process = self.furuta(*arguments)
        out, err = process.communicate(timeout=TIMEOUT)
        return process.returncode, out, err.replace(f"{NOTICE}\n", "")

    def start(self, *command: str | Path) -> subprocess.Popen[str]:
        """Start a command."""
        process = subprocess.Popen(
            list(map(str, command)),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=os.environ | {"COLUMNS": WIDTH},
        )
        self._all.append(process)
        return process

    def close(self) -> None:
        """End what still runs; a process that Ctrl-C does not end fails its test."""
        for process in self._all:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
        killed = []
        for process in self._all:
            try:
                process.communicate(timeout=GRACE)
            except subprocess.TimeoutExpired:
                process.kill()
                process.communicate()
                killed.append(process.args)
        assert not killed, f"did not end by Ctrl-C: {killed}"


def wait_until_ready(process: subprocess.Popen[str], nodes: int) -> None:
    """Read the log of a process until so many nodes are ready."""
    assert process.stderr is not None
    while nodes:
        line = process.stderr.readline()
        assert line, "the process ended before its nodes were ready"
        nodes -= "ready" in line


def wait_for(condition: Callable[[], Any]) -> Any:
    """The first true result of the condition."""
    deadline = monotonic() + TIMEOUT
    while not (result := condition()):
        assert monotonic() < deadline, "the awaited condition did not come true"
        sleep(0.002)
    return result


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Wait a second for a node that does not exist."""
    monkeypatch.setattr(ServiceCaller.call, "__defaults__", (1.0, ATTEMPTS))


class EmulatedRig:
    """A rig_emulator process with its port and its monitor."""

    def __init__(self, processes: Processes, directory: Path, *arguments: str | Path) -> None:
        self.port, self._monitor = directory / "port", directory / "monitor"
        self.process = processes.start(
            executable("furuta_hw", "rig_emulator"),
            *("--link", self.port, "--monitor", self._monitor, *arguments),
        )
        self._status_time = -inf
        assert self.process.stdout is not None
        assert self.process.stdout.readline().startswith("port: ")

    def ask(self, do: str, **arguments: Any) -> dict[str, Any]:
        """Send a request to its monitor; raises OSError without an answer."""
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
            connection.settimeout(ANSWER_TIMEOUT)
            connection.connect(str(self._monitor))
            with connection.makefile("rw") as lines:
                lines.write(json.dumps({"do": do, **arguments}) + "\n")
                lines.flush()
                answer: dict[str, Any] = json.loads(lines.readline())
        assert "error" not in answer, answer
        self._status_time = -inf  # the request may have changed it
        return answer

    @property
    def status(self) -> dict[str, Any]:
        """Its status, at most ``STATUS_AGE`` old: requests delay the emulator."""
        if monotonic() - self._status_time > STATUS_AGE:
            self._status = self.ask("status")
            self._status_time = monotonic()
        return self._status

    def log(self, path: Path) -> dict[str, np.ndarray]:
        """Its log so far, column by column."""
        self.ask("save", path=str(path))
        with np.load(path) as table:
            return dict(table)


@pytest.fixture
def emulate(processes: Processes, tmp_path: Path) -> Callable[..., EmulatedRig]:
    """Start an emulated rig."""
    return partial(EmulatedRig, processes, tmp_path)


@pytest.fixture
def processes() -> Iterator[Processes]:
    """Starts processes and ends them after the test."""
    processes = Processes()
    yield processes
    processes.close()


@pytest.fixture
def furuta(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> Callable[..., tuple[int, str, str]]:
    """Run a verb in this process: exit status, standard output, standard error.

    A test that has started ROS itself, that sends signals, or whose verb becomes another program
    uses ``processes.run``.
    """
    monkeypatch.setenv("COLUMNS", WIDTH)
    monkeypatch.delattr(os, "execv")  # it would replace the process of the tests

    def run(*arguments: str | Path | float) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["furuta", *map(str, arguments)])
        monkeypatch.setattr(logging.root, "handlers", [])  # made again, for this standard error
        handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
        capfd.readouterr()
        with pytest.raises(SystemExit) as ended:
            main.run_verb()
        for number, handler in handlers.items():
            signal.signal(number, handler)
        out, err = capfd.readouterr()
        return int(ended.value.code or 0), out, err.replace(f"{NOTICE}\n", "")

    return run


@pytest.fixture
def answer(furuta: Callable[..., tuple[int, str, str]]) -> Callable[..., Any]:
    """Run a verb that succeeds: its JSON."""

    def run(*arguments: str | Path | float) -> Any:
        status, out, err = furuta(*arguments, "--json")
        assert status == 0, err
        return json.loads(out)

    return run
