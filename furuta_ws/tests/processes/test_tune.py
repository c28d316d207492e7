"""``furuta tune`` as a user runs it."""

import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from furuta.settings.settings import read_file

Furuta = Callable[..., Any]


@pytest.mark.long
def test_interrupted_tuning_restores_parameters(processes: Any, furuta: Furuta) -> None:
    """Ctrl-C ends the tuning of a running graph with one line and the initial parameters."""
    run = processes.furuta("run", "--lockstep", "--set", "compensation=coulomb")
    while furuta("param", "get", "friction_observer", "compensation")[0] != 0:
        assert run.poll() is None
    tuning = processes.furuta("tune", "--running")
    for line in tuning.stderr:
        if "as it is" in line:
            break
    else:
        pytest.fail("tuning ended before its first trial")
    while furuta("param", "get", "friction_observer", "compensation")[1].strip() == "coulomb":
        assert tuning.poll() is None
    tuning.send_signal(signal.SIGINT)
    _, err = tuning.communicate(timeout=120.0)
    assert tuning.returncode == 1
    assert "interrupted; the initial parameters are restored" in err
    assert "Traceback" not in err
    assert furuta("param", "get", "friction_observer", "compensation")[1].strip() == "coulomb"


def test_tune_writes_a_parameter_file(answer: Furuta, tmp_path: Path) -> None:
    """The result is better than the start, printed as JSON, written to a valid file, and drawn."""
    file, figure = tmp_path / "tuned.yaml", tmp_path / "tuned.png"
    given = "--set", "drive.delay=10", "--set", "compensation=lugre"
    found = answer("tune", "--seconds", 110, *given, "--out", file, "--figure", figure)
    assert found["after"]["swing_rad"] < found["before"]["swing_rad"]
    assert found["pendulum_seconds"] <= 110
    assert found["trials"][0] == found["before"]
    assert {node: read_file(file)[node] for node in found["parameters"]} == found["parameters"]
    assert figure.stat().st_size > 10_000
