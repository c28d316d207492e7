"""Two graphs at once: each has its own loop, or the second does not start."""

import json
import signal
from pathlib import Path
from typing import Any

import pytest


@pytest.mark.parametrize(
    "how",
    ["run", *(pytest.param(how, marks=pytest.mark.long) for how in ("run --processes", "node"))],
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
