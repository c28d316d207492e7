"""Two graphs at once: each has its own loop, or the second does not start."""

import json
import signal
import sys
from pathlib import Path
from threading import Thread
from typing import Any

import flood
import numpy as np
import pytest
from std_srvs.srv import Trigger

from furuta_graph.composed_graph import SimulatedGraph
from furuta_graph.settings.settings import load_settings
from furuta_model.state import PHI
from furuta_ros.spinning import spin_until


@pytest.mark.parametrize(
    "how", ["run", pytest.param("run --processes", marks=pytest.mark.long), "node"]
)
def test_a_second_graph_does_not_start(processes: Any, how: str) -> None:
    """Beside one in its namespace and domain; the first one goes on."""
    first = processes.ready_node("plant")
    if how == "node":
        second = processes.node("plant")
        _, err = second.communicate(timeout=60.0)
        status = second.returncode
    else:
        status, _, err = processes.run(*how.split(), "--lockstep")
    assert status == 1
    assert "a graph already runs in namespace / of ROS domain" in err
    assert first.poll() is None


@pytest.mark.long
def test_a_graph_starts_again_after_a_kill(processes: Any) -> None:
    """At once: a kill ends its claim too."""
    first = processes.ready_node("plant")
    first.send_signal(signal.SIGKILL)
    first.wait()
    status, out, err = processes.run("run", "--lockstep", "--seconds", "2")
    assert (status, out) == (0, "2000 samples, 2.000 s\n"), err


@pytest.mark.long
def test_the_demo_beside_a_graph(processes: Any, tmp_path: Path) -> None:
    """It gives the figures of the demo alone, and the other graph receives nothing from it."""
    summaries = []
    for name in ("alone", "beside"):
        if name == "beside":
            graph = processes.furuta("run", "--realtime")
        out = tmp_path / name
        status, text, err = processes.run("demo", "--seconds", "8", "--out", out, "--json")
        assert status == 0, err
        runs = json.loads(text)["runs"]
        summaries.append([{k: v for k, v in run.items() if "wall" not in k} for run in runs])
    assert summaries[0] == summaries[1]
    graph.send_signal(signal.SIGINT)
    out, err = graph.communicate(timeout=60.0)
    assert graph.returncode == 0
    assert "rejected" not in err


@pytest.mark.realtime
@pytest.mark.parametrize("floods", [2, pytest.param(50, marks=pytest.mark.long)])
def test_a_flood_of_commands_is_not_applied(ros: None, processes: Any, floods: int) -> None:
    """Bursts of 10 V on a loaded machine: none is accepted; the arm within its limits, or 0 V.

    A loop that the machine gives no processor lets the pendulum fall, and the arm coasts at 0 V.
    """
    running = SimulatedGraph(load_settings([], ["compensation=lugre"]))
    plant, received = running.plant, []
    applied = [0.0]
    apply, move = plant.pacing.on_command, plant.move
    plant.pacing.on_command = lambda command: (received.append(command), apply(command))
    plant.move = lambda command: (applied.append(command), move(command))
    load = [processes.start(sys.executable, "-c", "while True: pass") for _ in range(2)]
    limit = 2 * np.pi
    for _ in range(floods):
        spin_until(running.executor, lambda: bool(received))
        process = processes.start(*flood.COMMAND)
        seen: list[str] = []
        thread = Thread(target=lambda p=process, s=seen: s.append(p.stdout.readline()))
        thread.start()
        spin_until(running.executor, lambda s=seen: bool(s))
        end = plant.time + 2.0
        while plant.time < end:
            running.executor.spin_once(timeout_sec=0.05)
            assert abs(plant.x[PHI]) < limit or applied[-1] == 0.0
        assert flood.VOLTS not in received
        process.terminate()
        process.wait()
        thread.join()
        received.clear()
        plant._reset(Trigger.Request(), Trigger.Response())
    for busy in load:
        busy.kill()
    running.close()
