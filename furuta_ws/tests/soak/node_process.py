"""Node processes that are killed, paused and started again."""

import os
import signal
import subprocess
from collections.abc import Iterable
from pathlib import Path
from time import monotonic, monotonic_ns, sleep
from typing import Any

import flood
import numpy as np

from furuta_graph.processes import executable
from furuta_graph.settings.nodes import NODES
from furuta_ros.process_start import INTERRUPTED
from soak.oracles import unexplained_end, wrong_second_graph
from soak.record import Record

# Time for a process to end after a signal, and for a short run [s].
GRACE, LONGEST = 10.0, 120.0
# Time in which a node on a busy machine is ready [s]. A signal before ends it with INTERRUPTED, or
# by itself, before Python can say anything.
STARTING, NOT_READY = 30.0, (INTERRUPTED, -signal.SIGINT)


class NodeProcess:
    """A node in a process of its own, with its log in a file: a full pipe would stop it."""

    def __init__(self, name: str, directory: Path, *arguments: str) -> None:
        self.name = name
        self._log = directory / f"{name}.stderr"
        about = NODES[name]
        ros = [part for argument in arguments for part in ("-p", argument)]
        self._command = [
            str(executable(about.package, about.executable)),
            *(["--ros-args", *ros] if ros else []),
        ]
        self.start()

    def start(self) -> None:
        """Start it, or start it again after its end."""
        with self._log.open("w") as log:
            self.process = subprocess.Popen(
                self._command, stdout=log, stderr=log, env=os.environ | {"PYTHONFAULTHANDLER": "1"}
            )
        self.started = monotonic()

    @property
    def log(self) -> str:
        """What it has written since its start."""
        return self._log.read_text(errors="replace")

    def kill(self) -> int:
        """SIGKILL; returns the time [ns] of the steady clock after its end."""
        self.process.kill()
        self.process.wait()
        return monotonic_ns()

    def abort(self) -> str:
        """End a process that does not react; returns where its threads were."""
        before = len(self.log)
        self.process.send_signal(signal.SIGABRT)
        try:
            self.process.wait(GRACE)
        finally:
            self.kill()
        return self.log[before:]

    def pause(self, seconds: float) -> tuple[int, int]:
        """SIGSTOP, and SIGCONT after some time.

        Returns the times [ns] of the steady clock between which no thread of it ran: on a busy
        machine some run on for a while after the signal.
        """
        pid = self.process.pid
        self.process.send_signal(signal.SIGSTOP)
        try:
            os.waitid(os.P_PID, pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)
            stopped = monotonic_ns()
            sleep(seconds)
        finally:
            back = monotonic_ns()
            self.process.send_signal(signal.SIGCONT)
        return stopped, back

    def check(self, record: Record) -> None:
        """Check that it runs on, or gives a reason; a process that has ended is started again."""
        status = self.process.poll()
        problem = unexplained_end(status, self.log)
        record.check("survival", f"{self.name}: {problem}" if problem else "")
        if status is not None:
            self.start()


def flood_commands(random: np.random.Generator) -> None:
    """Publish many commands in a process of their own, for up to 2 s from when they arrive."""
    process = subprocess.Popen(flood.COMMAND, stdout=subprocess.PIPE)
    try:
        assert process.stdout is not None
        process.stdout.readline()
        sleep(float(random.uniform(0.2, 2.0)))
    finally:
        process.kill()
        process.wait()


def second_graph(record: Record, namespace: str) -> None:
    """Start a graph beside this one, in its namespace or in another one."""
    furuta = str(executable("furuta_bringup", "furuta"))
    own = ["--namespace", namespace] if namespace else []
    process = subprocess.Popen(
        [furuta, "run", "--lockstep", "--seconds", "2", *own],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    out, _ = process.communicate(timeout=LONGEST)
    problem = wrong_second_graph(process.returncode, out, bool(namespace))
    record.check("second graph", problem)


def end(processes: Iterable[NodeProcess], record: Record) -> None:
    """End the processes with SIGINT, and check how they end."""
    for each in processes:
        each.process.send_signal(signal.SIGINT)
    for each in processes:
        status: Any
        try:
            status = each.process.wait(GRACE)
        except subprocess.TimeoutExpired:
            status = f"none: SIGINT did not end it; it was here: {each.abort()}"
        starting = monotonic() - each.started < STARTING and status in NOT_READY
        problem = "" if status == 0 or starting else f"status {status}"
        problem = problem or unexplained_end(None, each.log)
        record.check("survival", f"{each.name}, SIGINT: {problem}" if problem else "")
