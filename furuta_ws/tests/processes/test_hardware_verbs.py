"""``furuta hw`` and ``run --plant hardware`` as a user runs them."""

from pathlib import Path
from typing import Any

import pytest
from bridge_bench import PERMISSIVE_RIG
from processes.conftest import wait_for
from rosbags.highlevel import AnyReader

from furuta.settings.settings import read_file


@pytest.mark.realtime
def test_line_and_sensors(answer: Any, emulate: Any) -> None:
    """Check, read and zero on an emulated rig, each as one JSON object; none drives."""
    rig = emulate("--initial", "theta=0.1")
    checked = answer("hw", "check", "--port", rig.port, "--seconds", 1)
    assert checked["samples"] == 1000
    assert checked["corrupt"] == 0
    read = answer("hw", "read", "--port", rig.port, "--seconds", 0.5)
    assert read["theta_rad"] == pytest.approx(0.1, abs=0.003)
    zero = answer("hw", "zero", "--port", rig.port)
    assert zero["pendulum.zero"] == pytest.approx(0.1 / 0.785 * 2048, abs=2)
    assert rig.status["driven"] == 0


@pytest.mark.realtime
def test_run_on_a_rig_and_record(furuta: Any, emulate: Any, tmp_path: Path) -> None:
    """Not armed, it drives nothing; the bag has measurements, commands and parameters."""
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


@pytest.mark.long
def test_a_run_of_limited_time_ends_when_the_rig_is_gone(
    furuta: Any, processes: Any, emulate: Any
) -> None:
    """Its time is counted in samples, which stop."""
    rig = emulate()
    run = processes.furuta("run", "--plant", "hardware", "--port", rig.port, "--seconds", "1000")
    assert "active, not armed" in run.stdout.readline()
    rig.process.kill()
    _, err = run.communicate(timeout=120)
    assert run.returncode == 1
    assert "the rig has sent no sample for 10 s" in err


def test_arming_by_the_verb(furuta: Any, processes: Any, emulate: Any, tmp_path: Path) -> None:
    """State, arm and disarm on a running bridge; a reason where arming is not possible."""
    file = tmp_path / "permissive.yaml"
    file.write_text(PERMISSIVE_RIG)
    rig = emulate("--rig", file, "--lockstep")
    run = processes.furuta("run", "--plant", "hardware", "--port", rig.port, "--rig", file)
    assert "active, not armed" in run.stdout.readline()
    assert furuta("hw", "state")[1].strip() == "active"
    status, _, err = furuta("hw", "arm")
    assert status == 0, err
    wait_for(lambda: rig.status["driven"] > 0 and rig.status["armed"])
    assert furuta("hw", "disarm")[0] == 0
    wait_for(lambda: not rig.status["armed"])
    assert furuta("hw", "state", "deactivate")[1].strip() == "inactive"
    status, _, err = furuta("hw", "arm")
    assert (status, err.strip()) == (1, "error: not armed: the bridge is inactive, must be active")
