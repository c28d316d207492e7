"""``furuta tune``, ``experiment`` and ``sensitivity`` as a user runs them."""

from __future__ import annotations

import json
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from furuta_graph.settings import read_file

Furuta = Callable[..., Any]
SHORT = ("--fit", "alpha0", "--search", "sigma1", "--seconds", "110")


def test_interrupted_tuning_puts_parameters_back(processes: Any, furuta: Furuta) -> None:
    """On a running graph Ctrl-C ends it with one line and the earlier parameters."""
    processes.furuta("run", "--lockstep", "--set", "compensation=coulomb")
    tuning = processes.furuta("tune", "--running")
    for line in tuning.stderr:
        if "listening" in line:
            break
    # None while it listens, LuGre once it tries: how far it is depends on the machine's speed.
    assert furuta("param", "get", "friction_observer", "compensation")[1].strip() != "coulomb"
    tuning.send_signal(signal.SIGINT)
    _, err = tuning.communicate(timeout=60)
    assert tuning.returncode == 1
    assert "interrupted, the earlier parameters are restored" in err
    assert "Traceback" not in err
    assert furuta("param", "get", "friction_observer", "compensation")[1].strip() == "coulomb"


def test_nothing_to_tune(furuta: Furuta) -> None:
    """Without a running graph there is one line that says so."""
    status, out, err = furuta("tune", "--running")
    assert (status, out) == (1, "")
    assert err.startswith("error: no node")


def test_tune_writes_a_parameter_file(furuta: Furuta, tmp_path: Path) -> None:
    """What was found is printed as JSON, and kept in a file that the nodes take."""
    file = tmp_path / "tuned.yaml"
    status, out, err = furuta("tune", *SHORT, "--json", "--out", file)
    assert status == 0, err
    found = json.loads(out)
    assert found["after"]["phi_peak_to_peak_rad"] < found["before"]["phi_peak_to_peak_rad"] + 0.01
    assert found["pendulum_seconds"] <= 110
    assert read_file(file)["friction_observer"] == found["parameters"]
    assert yaml.safe_load(file.read_text())["friction_observer"]


@pytest.mark.parametrize(
    ("arguments", "status", "message"),
    [
        (("tune", "--seconds", "20"), 1, "needs at least"),
        (("tune", "--search", "omega1"), 2, "omega1"),
        (("tune", "--set", "method=lowpass"), 1, "method must be kalman"),
        (("tune", "--set", "enabled=false"), 1, "earlier parameters are restored"),
        (("tune", "--running", "--set", "seed=1"), 1, "--running cannot be combined"),
        (("tune", "--set", "sensors.ideal=true", "--set", "alpha0=0", "--set", "alpha1=0"), 1, ""),
        (("experiment", "fig4"), 2, "fig4"),
        (("experiment",), 2, "Missing argument"),
        (("experiment", "fig6", "--seconds", "1"), 2, "range 5<=x<=3600"),
    ],
)
def test_what_is_refused(
    furuta: Furuta, arguments: tuple[str, ...], status: int, message: str
) -> None:
    """One line that says what is allowed, no traceback, nothing on standard output."""
    got, out, err = furuta(*arguments)
    assert (got, out) == (status, "")
    assert message in err
    assert "Traceback" not in err


def test_experiment_draws_its_figure(furuta: Furuta, tmp_path: Path) -> None:
    """A row of JSON and a picture for each figure that was asked for."""
    arguments = ("fig6", "fig7", "--seconds", "10", "--json", "--out", tmp_path)
    status, out, err = furuta("experiment", *arguments)
    assert status == 0, err
    rows = json.loads(out)["experiments"]
    assert [row["experiment"] for row in rows] == ["fig6", "fig7"]
    assert rows[0]["phi_peak_to_peak_rad"] > 10 * rows[1]["phi_peak_to_peak_rad"]
    for name in ("fig6", "fig7"):
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")
