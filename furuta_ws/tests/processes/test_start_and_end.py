"""How processes start and end: Ctrl-C at any moment, killed parents, children that fail."""

import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from processes.conftest import TIMEOUT, wait_for, wait_until_ready

from furuta.settings.nodes import NODES
from furuta_bringup.graph.processes import executable

FURUTA = ("furuta_bringup", "furuta")
SIGINT_BIT = 1 << (signal.SIGINT - 1)
GRAPH = ("plant", "estimator", "friction_observer", "controller")

# What a process has loaded when Ctrl-C comes; nothing: as soon as it is executed.
INTERRUPTED = [
    (("furuta_sim", "plant"), "rclpy_pybind11"),
    ((*FURUTA, "run"), ""),
    ((*FURUTA, "simulate", "--seconds", "100000"), "llvmlite"),
]
BLOCKED_GRAPH = """
import ctypes, sys
from furuta_bringup.main import run_verb
from furuta_sim.plant_node import PlantNode

PlantNode.destroy_node = lambda node: ctypes.PyDLL(None).pause()  # keeps Python's lock
sys.argv = ["furuta", "run", "--lockstep", "--seconds", "1", "--record", sys.argv[1]]
run_verb()
"""
SLOW_START = """
import sys, time
from furuta_ros.spinning import run_node

def make():
    print("starting", flush=True)
    time.sleep(1000)

sys.argv = ["slow"]
run_node(make)
"""


def proc(pid: int, name: str) -> str:
    """A file of /proc about a process, or nothing once it has ended."""
    try:
        return Path(f"/proc/{pid}/{name}").read_text()
    except (FileNotFoundError, ProcessLookupError, PermissionError):
        return ""


def blocks_interrupt(pid: int) -> bool:
    """Whether SIGINT is blocked, as from the start of an executable to its first line."""
    lines = (line for line in proc(pid, "status").splitlines() if line.startswith("SigBlk"))
    return any(int(line.split()[1], 16) & SIGINT_BIT for line in lines)


def children(pid: int) -> list[int]:
    return [int(each) for each in proc(pid, f"task/{pid}/children").split()]


def runs(pid: int) -> bool:
    """Whether a process runs and is not merely waiting to be reaped."""
    state = proc(pid, "stat").rpartition(")")[2].split()
    return bool(state) and state[0] != "Z"


def end_of(process: subprocess.Popen[str]) -> tuple[int, str, str]:
    out, err = process.communicate(timeout=TIMEOUT)
    return process.returncode, out, err


@pytest.mark.parametrize(("command", "stage"), INTERRUPTED)
def test_interrupt_during_the_start(processes: Any, command: tuple[str, ...], stage: str) -> None:
    """Ctrl-C at any moment of a start ends a process with status 130 and without a traceback."""
    process = processes.start(executable(*command[:2]), *command[2:])
    if stage:
        wait_for(lambda: stage in proc(process.pid, "maps"))
    else:
        wait_for(lambda: blocks_interrupt(process.pid))
    process.send_signal(signal.SIGINT)
    status, out, err = end_of(process)
    assert (status, out, err.strip()) == (130, "", "")


def test_a_long_simulation_shows_its_progress_and_ends_at_once(processes: Any) -> None:
    """By Ctrl-C, on a terminal."""
    process, terminal = on_terminal("simulate --seconds 20000")
    shown = b""
    while b"simulating" not in shown:
        shown += os.read(terminal, 1000)
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=TIMEOUT)
    while b"interrupted" not in shown:
        shown += os.read(terminal, 1000)
    os.close(terminal)
    assert (process.returncode, out) == (130, "")


def on_terminal(command: str, folder: Path | None = None) -> tuple[subprocess.Popen[str], int]:
    """A verb whose standard error is a terminal, and the other end of that."""
    terminal, inner = os.openpty()
    words = [str(executable(*FURUTA)), *command.split()]
    with os.fdopen(inner) as error:
        process = subprocess.Popen(
            words, stdout=subprocess.PIPE, stderr=error, cwd=folder, text=True
        )
    return process, terminal


def test_a_node_ends_while_it_starts(processes: Any) -> None:
    """At once: who ends it does not wait until it has compiled."""
    process = processes.start(sys.executable, "-c", SLOW_START)
    assert process.stdout.readline() == "starting\n"
    process.send_signal(signal.SIGTERM)
    assert end_of(process) == (143, "", "")


# What a terminal shows while a command works, which ends with this status.
SHOWN = {
    "simulate --seconds 30": (0, "simulating"),
    "run --lockstep --seconds 0.1 --record bag": (0, "starting the nodes"),
    "bag replay bag --rate 0": (0, "replaying"),
    "bag export bag --out bag.csv": (0, "reading bag"),
    "bag recover bag": (0, "recovering bag"),
    "swing-up --starts 2": (0, "swinging up"),
    "hw check --port mock --seconds 0.1": (0, "checking"),
    "param get observer alpha0": (1, "looking for observer"),
}


def test_a_terminal_shows_what_is_done(tmp_path: Path) -> None:
    """On standard error; in a pipe nothing."""
    for command, (expected, text) in SHOWN.items():
        process, terminal = on_terminal(command, tmp_path)
        shown = b""
        with suppress(OSError):  # the end of a terminal
            while data := os.read(terminal, 1000):
                shown += data
        os.close(terminal)
        out, _ = process.communicate(timeout=TIMEOUT)
        assert (process.returncode, text in shown.decode()) == (expected, True), command
        assert text not in out


def test_every_executable_starts_with_interrupts_blocked() -> None:
    """Python would answer SIGINT with a traceback before the first line of the executable runs."""
    names = [*((each.package, each.executable) for each in NODES.values()), FURUTA]
    names.append(("furuta_hw", "rig_emulator"))
    for name in names:
        first_line = executable(*name).read_text().splitlines()[0]
        assert first_line.startswith("#!/usr/bin/env -S --block-signal=INT ")


@pytest.mark.parametrize(
    ("number", "ready"),
    [(signal.SIGTERM, False), pytest.param(signal.SIGKILL, True, marks=pytest.mark.long)],
    ids=str,
)
def test_no_child_outlives_its_parent(processes: Any, number: int, ready: bool) -> None:
    """Whatever ends ``run --processes``, also while the nodes are starting."""
    parent = processes.furuta("run", "--processes")
    pids = wait_for(lambda: len(found := children(parent.pid)) == len(GRAPH) and found)
    if ready:
        wait_until_ready(parent, len(GRAPH))
    parent.send_signal(number)
    wait_for(lambda: not any(runs(pid) for pid in pids))
    status, _, err = end_of(parent)
    assert status == (-number if number == signal.SIGKILL else 0 if ready else 143), err
    assert "Traceback" not in err


def test_a_failed_node_is_named(processes: Any) -> None:
    """``run --processes`` ends with the status of the node that failed, and says which."""
    parent = processes.furuta("run", "--processes")
    pids = wait_for(lambda: len(found := children(parent.pid)) == len(GRAPH) and found)
    wait_until_ready(parent, len(GRAPH))
    os.kill(next(pid for pid in pids if "/estimator" in proc(pid, "cmdline")), signal.SIGKILL)
    status, _, err = end_of(parent)
    assert (status, err.splitlines()[-1]) == (137, "error: estimator was ended by SIGKILL")
    assert not any(runs(pid) for pid in pids)


@pytest.mark.parametrize("name", [("furuta_sim", "plant"), ("furuta_hw", "rig_emulator")])
def test_a_bogus_option_is_one_sentence(processes: Any, name: tuple[str, str]) -> None:
    """Status 2, and one line that names the option."""
    status, out, err = end_of(processes.start(executable(*name), "--bogus"))
    assert (status, out, len(err.splitlines())) == (2, "", 1)
    assert err.startswith("error: ")
    assert "--bogus" in err


def test_a_bridge_without_a_rig_is_not_ready(processes: Any) -> None:
    """It gives the reason instead, and waits to be configured again."""
    process = processes.node("hardware_bridge", "autostart:=active", "port:=/dev/nowhere")
    lines = []
    while "not ready" not in (lines or [""])[-1]:
        lines.append(process.stderr.readline())
        assert lines[-1], "".join(lines)
    assert "not ready: unconfigured instead of active: " in lines[-1]
    assert "/dev/nowhere" in lines[-1]
    process.send_signal(signal.SIGTERM)
    status, _, err = end_of(process)
    assert status == 0
    assert "ready" not in "".join(lines[:-1]) + err


def test_a_graph_ends_though_the_middleware_does_not(processes: Any, tmp_path: Path) -> None:
    """With status 0, its report, and its bag closed."""
    bag = tmp_path / "bag"
    status, out, err = end_of(processes.start(sys.executable, "-c", BLOCKED_GRAPH, bag))
    assert (status, out.splitlines()[-1]) == (0, "1000 samples, 1.000 s"), err
    assert sorted(file.suffix for file in bag.iterdir()) == [".mcap", ".yaml", ".yaml"]
