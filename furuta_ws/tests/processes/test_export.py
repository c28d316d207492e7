"""``furuta export c``, and a rig with the loop on board whose graph is killed."""

import json
import os
import signal
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import pytest
from processes.conftest import wait_for

from furuta_hw.protocol import frames
from furuta_hw.protocol.frames import encode

PATIENCE = 120.0
# Samples that the pendulum is balanced after the graph has been killed; its watchdog has 50.
ALONE = 5000
# A loaded machine delays processes; the guard would stop the rig before the kill.
RIG = "{line: {watchdog: 0.2}, limits: {command_age: 5, measurement_age: 5, estimate_age: 5}}"


def test_files(furuta: Any, tmp_path: Path) -> None:
    """Names and sizes as printed; the header has parameters, units, and the rig's sources."""
    options = ("--rig", "qube_servo_2", "--set", "compensation=lugre", "--float")
    status, out, err = furuta("export", "c", *options, "--out", tmp_path / "new", "--json")
    assert status == 0, err
    answer = json.loads(out)
    files = list(map(Path, answer["files"]))
    assert [file.name for file in files] == ["loop.h", "loop.c", "loop_test.c"]
    assert answer["bytes"] == sum(file.stat().st_size for file in files)
    header = " ".join(files[0].read_text().split())
    assert "Quanser Qube-Servo 2" in header and "compensation = lugre" in header
    assert "sigma0 = 80.0 V/rad: bristle stiffness" in header
    assert "#define LOOP_REAL float" in header


@pytest.mark.long
@pytest.mark.realtime
@pytest.mark.timeout(900)
def test_killed_graph(furuta: Any, processes: Any, emulate: Any, tmp_path: Path) -> None:
    """The rig keeps its balance, still armed; a new session sets 0 V."""
    pytest.importorskip("ziglang", reason="pip install -r firmware/requirements.lock")
    rig_file = tmp_path / "rig.yaml"
    rig_file.write_text(RIG)
    tuned = ("--rig", rig_file, "--set", "compensation=lugre")
    assert furuta("export", "c", *tuned, "--float", "--out", tmp_path / "loop")[0] == 0
    rig = emulate("--loop", tmp_path / "loop", "--rig", rig_file)
    graph = processes.furuta("run", "--plant", "hardware", "--port", rig.port, *tuned)
    end, refusal = monotonic() + PATIENCE, ""
    while not rig.ask("status")["armed"]:
        assert monotonic() < end, refusal
        rig.ask("hold")
        _, _, refusal = processes.run("hw", "arm")
    graph.send_signal(signal.SIGKILL)
    graph.wait()
    until = rig.status["sample"] + ALONE
    wait_for(lambda: rig.status["sample"] >= until)
    status = rig.ask("status")
    assert status["armed"] and abs(status["state"][2]) < 0.2
    line = os.open(rig.port, os.O_RDWR | os.O_NOCTTY)
    os.write(line, b"\0" + encode(frames.HelloFrame(frames.VERSION, 9, 1000, 50)))
    sleep(0.5)
    os.close(line)
    status = rig.ask("status")
    assert (status["armed"], status["volts"]) == (False, 0.0)
