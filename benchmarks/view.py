"""Measures the page of ``furuta view`` in a headless browser. Each measurement prints JSON.

    tools/in_environment python benchmarks/view.py latency [ROUNDS] [SECONDS] [PRIORITY]
    tools/in_environment python benchmarks/view.py slider [PRESSES]
    tools/in_environment python benchmarks/view.py memory [MINUTES]
    tools/in_environment python benchmarks/view.py start

It needs Chromium and playwright (``furuta_ws/tests/requirements.lock``) and a quiet machine.
"""

import json
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import monotonic, sleep, time
from typing import Any

import numpy as np
from graph import Stopwatch
from rcl_interfaces.msg import ParameterEvent
from rclpy.node import Node

from furuta_graph.composed_graph import SimulatedGraph
from furuta_graph.processes import executable
from furuta_graph.scheduling import Scheduling, apply_scheduling
from furuta_graph.settings.settings import default_settings
from furuta_ros.context import ros_context
from furuta_ros.spinning import executor_of, spin_until
from furuta_ros.topics import QOS

DRIVER = Path(__file__).parents[1] / "furuta_ws" / "tests" / "page_driver.py"
SETTLE = 3.0  # [s] from an open or closed page to the measurement
MEMORY_SETTLE = 300.0  # [s] after which memory must not grow
MEGABYTE = 2.0**20
ANSWER = 10.0  # [s]
ALPHA0 = "believed alpha0 [V]"


class Browser:
    """A browser in a process of its own, driven by ``page_driver.py``."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, DRIVER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self._line()

    def ask(self, *command: str) -> float:
        """Send a command and wait for the answer."""
        self.send(*command)
        return float(self._line())

    def send(self, *command: str) -> None:
        """Send a command."""
        assert self._process.stdin is not None
        print(*command, sep="\t", file=self._process.stdin, flush=True)

    def close(self) -> None:
        """End the browser."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait()

    def _line(self) -> str:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise SystemExit("error: the browser has failed; its reason is above")
        return line


@contextmanager
def view(*arguments: str | Path) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """A view and the address of its page."""
    command = [executable("furuta_bringup", "furuta"), "view", "--no-open", *arguments]
    process = subprocess.Popen(list(map(str, command)), stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        yield process, process.stdout.readline().strip()
    finally:
        process.send_signal(signal.SIGINT)
        process.wait()


@contextmanager
def browser() -> Iterator[Browser]:
    """A browser that ends with the block."""
    started = Browser()
    try:
        yield started
    finally:
        started.close()


def latency(rounds: str = "4", seconds: str = "6", priority: str = "80") -> dict[str, Any]:
    """Latency from measurement to command at 1 kHz without and with an open page, in turns.

    ``priority`` is that of ``furuta run --priority``, 0 without. ``furuta view`` gives its graph 80
    where the system permits it.
    """
    watches = {"closed": Stopwatch(), "open": Stopwatch()}
    with browser() as shown, ExitStack() as context:
        for result in apply_scheduling(Scheduling(int(priority))):
            if "REFUSED" in result:
                raise SystemExit(f"error: {result}")
        context.enter_context(ros_context())
        settings = default_settings()
        settings["plant"] |= {"clock": "realtime", "run_until": 1e9}
        graph = SimulatedGraph(settings)
        plant: Any = graph.plant
        publish, on_command = plant.publish_sample, plant.pacing.on_command
        for _ in range(int(rounds)):
            for name, watch in watches.items():
                with ExitStack() as opened:
                    if name == "open":
                        _open_meanwhile(graph, opened, shown)
                    _spin(graph, SETTLE)
                    plant.publish_sample = watch.starting(publish)
                    plant.pacing.on_command = watch.stopping(on_command)
                    _spin(graph, float(seconds))
                    plant.publish_sample, plant.pacing.on_command = publish, on_command
                    watch.end_round()
        graph.close()
    closed, with_page = (watches[name].percentiles() for name in ("closed", "open"))
    ratios = np.median(with_page / closed, axis=0)
    return {
        "closed_p50_p99_us": (1e6 * np.median(closed, axis=0)).tolist(),
        "open_p50_p99_us": (1e6 * np.median(with_page, axis=0)).tolist(),
        "ratio_p50": float(ratios[0]),
        "ratio_p99": float(ratios[1]),
        "ratios_of_rounds": (with_page / closed).tolist(),
    }


def _open_meanwhile(graph: SimulatedGraph, opened: ExitStack, shown: Browser) -> None:
    """Open the page of the graph, which runs on meanwhile."""
    furuta = str(executable("furuta_bringup", "furuta"))
    # Without the priority of this process.
    command = ["chrt", "--other", "0", furuta, "view", "--no-open", "--attach"]
    file = Path(tempfile.mkdtemp()) / "address"
    process = subprocess.Popen(command, stdout=file.open("w"))

    def end() -> None:
        shown.ask("close")
        process.send_signal(signal.SIGINT)
        process.wait()
        shutil.rmtree(file.parent)

    opened.callback(end)
    spin_until(graph.executor, lambda: "\n" in file.read_text())
    shown.send("open", file.read_text().strip())
    _spin(graph, 2.0 * SETTLE)


def _spin(graph: SimulatedGraph, seconds: float) -> None:
    end = monotonic() + seconds
    spin_until(graph.executor, lambda: monotonic() > end)


def slider(presses: str = "30") -> dict[str, Any]:
    """Time from a key press on a slider to the parameter in force at the node [s]."""
    events: list[float] = []

    def receive(event: ParameterEvent) -> None:
        if any(parameter.name == "alpha0" for parameter in event.changed_parameters):
            events.append(event.stamp.sec + 1e-9 * event.stamp.nanosec)

    delays = []
    with ros_context(), view() as (_, address), browser() as shown:
        node = Node("watches_parameters")
        node.create_subscription(ParameterEvent, "/parameter_events", receive, QOS)
        executor = executor_of([node])
        shown.ask("open", address)
        for number in range(int(presses)):
            pressed = shown.ask("press", ALPHA0)
            end = monotonic() + ANSWER
            while len(events) <= number and monotonic() < end:
                executor.spin_once(timeout_sec=0.1)
            if len(events) != number + 1:
                raise SystemExit(f"error: {number + 1} key presses, {len(events)} changes")
            delays.append(events[-1] - pressed)
    return {"median_s": float(np.median(delays)), "worst_s": max(delays), "presses": len(delays)}


def memory(minutes: str = "60") -> dict[str, Any]:
    """Resident memory of graph and page with an open page, and its growth after 5 minutes [MB]."""
    rows: list[tuple[float, dict[str, float]]] = []
    with view() as (process, address), browser() as shown:
        shown.ask("open", address)
        start = monotonic()
        while monotonic() - start < 60.0 * float(minutes):
            rows.append((monotonic() - start, _children_memory(process.pid)))
            sleep(10.0)
    settled = [row for at, row in rows if at >= MEMORY_SETTLE] or [row for _, row in rows]
    return {
        name: {
            "first_mb": rows[0][1][name],
            "settled_mb": settled[0][name],
            "last_mb": settled[-1][name],
            "growth_mb": max(row[name] for row in settled) - settled[0][name],
        }
        for name in settled[0]
    }


def _children_memory(parent: int) -> dict[str, float]:
    """Resident memory of the child processes [MB]."""
    sizes = {}
    for child in Path(f"/proc/{parent}/task/{parent}/children").read_text().split():
        command = Path(f"/proc/{child}/cmdline").read_text().split("\0")
        pages = int(Path(f"/proc/{child}/statm").read_text().split()[1])
        sizes["page" if "--attach" in command else "graph"] = pages * 4096 / MEGABYTE
    return sizes


def start() -> dict[str, Any]:
    """Time from the command to the address and to the first moving curves [s]."""
    with browser() as shown:
        begun = time()
        with view() as (_, address):
            printed = time() - begun
            moving = shown.ask("open", address) - begun
    return {"address_s": printed, "moving_s": moving}


MEASUREMENTS = {function.__name__: function for function in (latency, slider, memory, start)}

if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1] not in MEASUREMENTS:
        raise SystemExit(f"error: give one of {', '.join(MEASUREMENTS)}")
    print(json.dumps(MEASUREMENTS[sys.argv[1]](*sys.argv[2:]), indent=2))
