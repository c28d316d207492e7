"""``furuta hw`` and ``run --plant hardware`` as a user meets them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from rosbags.highlevel import AnyReader

from furuta_graph.settings import read_file

pytestmark = pytest.mark.realtime


def test_rig_is_shown_and_printed(furuta: Any, tmp_path: Path) -> None:
    """A rig's model as JSON, and as a parameter file that other verbs take."""
    shown = json.loads(furuta("hw", "rig", "paper", "--json")[1])
    assert (shown["a23"], shown["b21"]) == (pytest.approx(-11), pytest.approx(45))
    file = tmp_path / "qube.yaml"
    file.write_text(furuta("hw", "rig", "qube_servo_2", "--params")[1])
    status, out, err = furuta("linearize", "--params", file, "--json")
    assert status == 0, err
    qube = json.loads(furuta("hw", "rig", "qube_servo_2", "--json")[1])
    assert json.loads(out)["alpha"] == qube["alpha"]


def test_line_and_sensors(furuta: Any, emulate: Any) -> None:
    """Check, read, zero and signs on a rig in software, each as one JSON object."""
    rig = emulate("--initial", "theta=0.1")
    checked = json.loads(furuta("hw", "check", "--port", rig.port, "--seconds", 1, "--json")[1])
    assert checked["samples"] == 1000
    assert checked["corrupt"] == 0
    read = json.loads(furuta("hw", "read", "--port", rig.port, "--seconds", 0.5, "--json")[1])
    assert read["theta_rad"] == pytest.approx(0.1, abs=0.003)
    zero = json.loads(furuta("hw", "zero", "--port", rig.port, "--json")[1])
    assert zero["pendulum.zero"] == pytest.approx(0.1 / 0.785 * 2048, abs=2)
    assert rig.status["driven"] == 0
    status, out, err = furuta("hw", "signs", "--port", rig.port, "--json")
    if status == 0:  # a stall of the machine may stop it, as it must
        assert json.loads(out) == {"arm.sign": 1, "speed.sign": 1, "pendulum.sign": None}
    else:
        assert "no measurement" in err or "watchdog" in err
    assert rig.status["volts"] == 0.0


def test_a_bad_line_fails_the_check(furuta: Any, emulate: Any) -> None:
    """Exit status 1 with the count."""
    rig = emulate("--fault", "lost=0.3")
    status, _, err = furuta("hw", "check", "--port", rig.port, "--seconds", 1)
    assert status == 1
    assert "frames were lost or corrupt" in err


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["hw", "rig", "nobody"], "no rig nobody; rigs are"),
        (["hw", "check", "--port", "/dev/nothing"], "cannot open /dev/nothing"),
        (["hw", "friction", "--port", "mock", "--travel", "0.2"], "travel must be at least"),
        (["hw", "emulate", "--fault", "gremlin=1"], "no fault gremlin"),
        (["run", "--plant", "hardware", "--port", "mock", "--lockstep"], "has its own clock"),
        (["run", "--plant", "hardware", "--port", "/dev/nothing"], "cannot open /dev/nothing"),
    ],
)
def test_bad_input_is_one_line(furuta: Any, arguments: list[str], reason: str) -> None:
    """Exit status 1, the reason on standard error, nothing on standard output."""
    status, out, err = furuta(*arguments)
    assert (status, out) == (1, "")
    assert reason in err
    assert len(err.strip().splitlines()) == 1


def test_run_on_a_rig_and_record(furuta: Any, emulate: Any, tmp_path: Path) -> None:
    """Not armed, it drives nothing; the bag has what was said and answered, and by what values."""
    rig, bag = emulate(), tmp_path / "bag"
    status, out, err = furuta(
        *("run", "--plant", "hardware", "--port", rig.port, "--rig", "paper"),
        *("--seconds", "1", "--record", bag),
    )
    assert status == 0, err
    assert "active, not armed" in out
    assert (rig.status["driven"], rig.status["volts"]) == (0, 0.0)
    with AnyReader([bag]) as reader:
        counts = {c.topic.lstrip("/"): c.msgcount for c in reader.connections}
    assert counts["measurement"] > 500
    assert counts["command"] > 400
    kept = read_file(bag / "parameters.yaml")
    assert kept["hardware_bridge"]["port"] == str(rig.port)
    assert kept["plant"]["actuator.bits"] == 12


def test_arming_by_the_verb(furuta: Any, processes: Any, emulate: Any) -> None:
    """State, arm and disarm on a running bridge; a reason where it cannot be."""
    rig = emulate()
    run = processes.furuta("run", "--plant", "hardware", "--port", rig.port)
    assert "active, not armed" in run.stdout.readline()
    assert furuta("hw", "state")[1].strip() == "active"
    for _ in range(5):  # a stall of the machine may stop it at once
        status, _, err = furuta("hw", "arm")
        if rig.ask("status")["driven"] > 0:
            break
    assert rig.ask("status")["driven"] > 0, (status, err)
    assert furuta("hw", "disarm")[0] == 0
    assert rig.ask("status")["armed"] is False
    assert furuta("hw", "state", "deactivate")[1].strip() == "inactive"
    status, _, err = furuta("hw", "arm")
    assert (status, err.strip()) == (1, "error: not armed: the bridge is inactive, must be active")
