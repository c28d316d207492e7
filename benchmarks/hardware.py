"""Compares the graph on an emulated rig behind a pseudo-terminal with the simulated plant.

    tools/in_environment python benchmarks/hardware.py [SECONDS] [--lockstep] [--firmware]

Prints one JSON object with, for each compensation: the arm's peak-to-peak angle in windows of 5 s
(median) and its RMS on the rig and in simulation, their ratios, the fraction of samples answered
before the next one, and the reasons of stops. A delay of the machine beyond the limits is such a
reason; the run continues after it. With --firmware the rig runs the C firmware for boards.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
import rclpy

from furuta_graph.composed_graph import HardwareGraph
from furuta_graph.processes import executable
from furuta_sim.emulator.monitor import ask
from furuta_sim.settings.settings import load_settings, loop
from furuta_sim.simulation.closed_loop import simulate

SECONDS = 60.0
PATIENT = {"command_age": 5.0, "estimate_age": 5.0, "measurement_age": 5.0}
WINDOW = 5000  # samples
SETTLING = 5000  # samples of a run that are left out


def spin(graph: HardwareGraph, seconds: float) -> None:
    """Run the graph."""
    end = monotonic() + seconds
    while monotonic() < end:
        graph.executor.spin_once(timeout_sec=0.05)


def run(compensation: str, seconds: float, options: list[str]) -> dict[str, Any]:
    """Drive the rig for ``seconds``, armed again after every stop.

    In lock-step the rig waits for every answer, so delays of the machine do not change the result.
    """
    with tempfile.TemporaryDirectory() as directory:
        port, monitor = Path(directory) / "port", Path(directory) / "monitor"
        rig = subprocess.Popen(
            [
                executable("furuta_sim", "rig_emulator"),
                *("--link", port, "--monitor", monitor),
                *options,
            ],
            stdout=subprocess.PIPE,
        )
        assert rig.stdout is not None
        rig.stdout.readline()
        file = Path(directory) / "rig.yaml"
        file.write_text(f"limits: {PATIENT if '--lockstep' in options else {}}")
        settings = load_settings(
            [],
            [
                *(f"compensation={compensation}", f"port={port}"),
                *(f"hardware_bridge.rig={file}", "autostart=active"),
            ],
        )
        graph = HardwareGraph(settings)
        reasons: list[str] = []
        end = monotonic() + seconds
        while monotonic() < end:
            if not graph.bridge.guard.armed:
                if graph.bridge.guard.stops:
                    reasons.append(graph.bridge.guard.reason)
                ask(monitor, "hold")
                spin(graph, 1.0)
                graph.bridge.arm()
            spin(graph, 0.1)
        status = ask(monitor, "status")
        ask(monitor, "save", path=str(Path(directory) / "log.npz"))
        graph.close()
        rig.terminate()
        rig.wait()
        with np.load(Path(directory) / "log.npz") as log:
            rig_windows = windows(log["phi"], log["armed"])
            armed = int(np.sum(log["armed"]))
    return {
        **measures(rig_windows),
        "armed_samples": armed,
        "answered_fraction": status["driven"] / max(1, armed),
        "rig_late_samples": status["late"],
        "stops": reasons,
    }


def windows(phi: np.ndarray, armed: np.ndarray) -> list[np.ndarray]:
    """Return the arm's angle in all complete windows of uninterrupted runs, without transients."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], armed, [0]))))
    return [
        phi[start : start + WINDOW]
        for begin, end in zip(edges[::2] + SETTLING, edges[1::2], strict=True)
        for start in range(begin, end - WINDOW + 1, WINDOW)
    ]


def measures(angles: list[np.ndarray]) -> dict[str, Any]:
    """Compute median peak-to-peak angle and RMS [rad] over the windows."""
    if not angles:
        return {"phi_peak_to_peak_rad": None, "rms_rad": None, "windows": 0}
    return {
        "phi_peak_to_peak_rad": float(np.median([np.ptp(window) for window in angles])),
        "rms_rad": float(np.sqrt(np.mean([np.var(window) for window in angles]))),
        "windows": len(angles),
    }


def simulated(compensation: str, seconds: float) -> dict[str, Any]:
    """Compute the same in simulation, which equals the simulated graph to the last bit."""
    phi = simulate(loop(load_settings([], [f"compensation={compensation}"])), seconds).state[:, 0]
    return measures(windows(phi, np.ones(len(phi))))


def main() -> None:
    """Measure with and without compensation."""
    options = [argument for argument in sys.argv[1:] if argument.startswith("--")]
    given = [argument for argument in sys.argv[1:] if not argument.startswith("--")]
    seconds = float(given[0]) if given else SECONDS
    result = {}
    for compensation in ("none", "lugre"):
        rclpy.init(args=[])
        rig = run(compensation, seconds, options)
        rclpy.shutdown()
        expected = simulated(compensation, 505.0)
        ratios = {
            f"{name}_ratio": rig[f"{name}_rad"] / expected[f"{name}_rad"]
            for name in ("phi_peak_to_peak", "rms")
            if rig["windows"]
        }
        result[compensation] = {"rig": rig, "simulated": expected} | ratios
    print(json.dumps(result, indent=2))


if __name__ == "__main__":
    main()
