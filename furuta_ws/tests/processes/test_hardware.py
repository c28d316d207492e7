"""The whole graph on a rig that speaks real bytes over a pseudo-terminal, in its own process."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic_ns
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from std_srvs.srv import SetBool
from testbench import Bench

from furuta_analysis.closed_loop import simulate
from furuta_analysis.oscillation import measure_oscillation
from furuta_bringup.processes import HARDWARE
from furuta_bringup.settings import gather, loop
from furuta_control.controller_node import Controller
from furuta_control.estimator_node import Estimator
from furuta_friction.friction_observer_node import FrictionObserver
from furuta_hw.bridge_node import HardwareBridge
from furuta_hw.rig import Rig
from furuta_ros.topics import COMMAND, MEASUREMENT
from rclpy.parameter import Parameter

RIG = Rig()
PERIOD = 1_000_000
WATCHDOG = RIG.watchdog_samples * PERIOD
# Rounds of kills; more of them on demand, for they take their time.
ROUNDS = int(os.environ.get("FURUTA_KILL_ROUNDS", "1"))
VICTIMS = ("hardware_bridge", "controller", "estimator", "friction_observer")


@contextmanager
def load() -> Iterator[None]:
    """Every core busy."""
    burners = [
        subprocess.Popen([sys.executable, "-c", "while True: pass"])
        for _ in range(os.cpu_count() or 1)
    ]
    try:
        yield
    finally:
        for burner in burners:
            burner.kill()
            burner.wait()


class Person:
    """Who puts the pendulum upright and arms the bridge."""

    def __init__(self, bench: Bench, rig: Any) -> None:
        self._bench, self._rig = bench, rig
        self._client = bench.probe.create_client(SetBool, "hardware_bridge/arm")

    def arm(self, armed: bool = True) -> tuple[bool, str]:
        """Ask the bridge once; it may not be there."""
        future = self._client.call_async(SetBool.Request(data=armed))
        end = monotonic_ns() + 2_000_000_000
        self._bench.spin(lambda: future.done() or monotonic_ns() > end)
        if not future.done():
            return False, "no answer"
        return future.result().success, future.result().message

    def balance(self, samples: int = 500) -> None:
        """Hold, arm, let go, until the rig has been driven upright for so many samples.

        A stall of the machine may stop it meanwhile, as it must: then again.
        """
        begun = None

        def balanced() -> bool:
            nonlocal begun
            status = self._rig.status
            if not status["armed"]:
                self._rig.ask("hold")
                self.arm()
                begun = self._rig.status["driven"]
                return False
            upright = abs(status["state"][2]) < 0.2
            return upright and begun is not None and status["driven"] > begun + samples

        self._bench.spin(balanced, timeout=90.0)


def composed(bench: Bench, rig: Any, compensation: str = "none", **limits: float) -> Any:
    """The graph in this process; the bridge, active."""
    rig_file = rig.port.parent / "rig.yaml"
    rig_file.write_text(f"limits: {limits}")
    bridge = bench.add(
        HardwareBridge(
            [
                Parameter("port", value=str(rig.port)),
                Parameter("rig", value=str(rig_file)),
                Parameter("autostart", value="active"),
            ]
        )
    )
    bench.add(Estimator())
    bench.add(FrictionObserver([Parameter("compensation", value=compensation)]))
    bench.add(Controller())
    assert bridge.state == "active", bridge.trouble
    return bridge


# Wide enough that a stall of the machine does not end a run in the rig's own time.
PATIENT = {"command_age": 5.0, "measurement_age": 5.0, "estimate_age": 5.0}


def test_lockstep_is_the_loop_to_the_last_bit(bench: Bench, emulate: Any, tmp_path: Path) -> None:
    """Through bytes and codes: measurements are the rig's, its voltages the commands."""
    rig = emulate("--lockstep")
    measurements, commands = bench.collect(MEASUREMENT), bench.collect(COMMAND)
    composed(bench, rig, "lugre", **PATIENT)
    Person(bench, rig).balance(1500)
    bench.spin(lambda: len(commands) > 100)
    trace = rig.trace(tmp_path / "trace.npz")
    armed = np.flatnonzero(trace["armed"])
    first = armed[0] + 5
    sent = {round(m.header.stamp.sec * 1e9) + m.header.stamp.nanosec: m for m in measurements}
    assert len(sent) == len(measurements)
    applied = np.array([m.effort[0] for m in measurements])
    drive = RIG.drive.channel
    quantised = [drive.to_si(drive.to_code(c.data)) for c in commands]
    # Both series in the order of the samples, from the moment that the rig was driven.
    tail = 1000
    volts = trace["volts"][first : first + tail]
    start = next(k for k in range(len(applied)) if np.array_equal(applied[k : k + tail], volts))
    phi = np.array([m.position[0] for m in measurements[start : start + tail]])
    arm = RIG.arm.channel
    expected = [arm.to_si(arm.to_code(p)) for p in trace["phi"][first : first + tail]]
    np.testing.assert_array_equal(phi, expected)
    assert any(np.array_equal(quantised[k : k + tail], volts) for k in range(len(quantised) - tail))


@pytest.mark.parametrize("compensation", ["none", "lugre"])
def test_limit_cycle_is_the_simulated_one(
    bench: Bench, emulate: Any, tmp_path: Path, compensation: str
) -> None:
    """Arm's travel over 20 s of the rig's time, in windows of 5 s, within 10 % of the simulation."""
    rig = emulate("--lockstep")
    bridge = composed(bench, rig, compensation, **PATIENT)
    person = Person(bench, rig)
    person.balance(100)
    begun = rig.status["sample"]
    bench.spin(lambda: bridge.samples % 1000 == 0 and rig.status["sample"] > begun + 30_000, 120.0)
    trace = rig.trace(tmp_path / "trace.npz")
    assert bridge.guard.stops == 0
    phi = trace["phi"][trace["armed"] > 0][10_000:30_000]
    got = np.median([np.ptp(window) for window in np.split(phi, 4)])
    record = simulate(loop(gather([], [f"compensation={compensation}"])), 30.0)
    windows = np.split(record.state[10_000:, 0], 4)
    assert got == pytest.approx(np.median([np.ptp(window) for window in windows]), rel=0.1)


def test_real_time_stabilises(bench: Bench, emulate: Any) -> None:
    """At 1 kHz the pendulum stands, and nearly every sample is answered."""
    rig = emulate()
    composed(bench, rig)
    Person(bench, rig).balance(3000)
    assert abs(rig.status["state"][2]) < 0.2


def test_kill_nine_of_each_node(bench: Bench, processes: Any, emulate: Any, tmp_path: Path) -> None:
    """Under load: 0 V within the watchdog's period every time, and the loop comes back."""
    rig = emulate()
    start = {
        name: (f"port:={rig.port}", "autostart:=active") if name == "hardware_bridge" else ()
        for name in HARDWARE
    }
    running = {name: processes.node(name, *start[name]) for name in HARDWARE}
    person = Person(bench, rig)
    with load():
        for _ in range(ROUNDS):
            for name in VICTIMS:
                person.balance()
                running[name].send_signal(signal.SIGKILL)
                running[name].wait()
                dead = monotonic_ns()
                bench.spin(lambda dead=dead: monotonic_ns() > dead + 5 * WATCHDOG)
                trace = rig.trace(tmp_path / "trace.npz")
                after = trace["time_ns"] > dead + WATCHDOG + PERIOD
                assert np.any(trace["volts"][~after][-2000:] != 0.0), name
                assert np.all(trace["volts"][after] == 0.0), name
                running[name] = processes.node(name, *start[name])
        person.balance()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_bridge_ends_cleanly(
    bench: Bench, processes: Any, emulate: Any, number: signal.Signals
) -> None:
    """Status 0, no traceback, rig disarmed by the bridge itself and not by its watchdog."""
    rig = emulate()
    running = {
        name: processes.node(
            name, *((f"port:={rig.port}", "autostart:=active") if "bridge" in name else ())
        )
        for name in HARDWARE
    }
    Person(bench, rig).balance(100)
    running["hardware_bridge"].send_signal(number)
    _, err = running["hardware_bridge"].communicate(timeout=30.0)
    assert running["hardware_bridge"].returncode == 0, err
    assert "Traceback" not in err
    bench.spin(lambda: not rig.status["armed"])
    assert rig.status["volts"] == 0.0


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        ({"lost": 0.6}, "lost or corrupt"),
        ({"corrupt": 0.6}, "lost or corrupt"),
        ({"silent": True}, "no measurement"),
        ({"late": 200}, ""),
        ({"potentiometer_rail": True}, "end of its range"),
        ({"encoder_stuck": True}, ""),
        ({"rig_fault": True}, ""),
    ],
    ids=lambda each: next(iter(each)) if isinstance(each, dict) else "",
)
def test_faults_stop_it_once_with_a_reason(
    bench: Bench, emulate: Any, fault: dict[str, Any], reason: str
) -> None:
    """0 V on both sides, one edge, the reason on /diagnostics; it runs again when re-armed."""
    rig = emulate()
    bridge = composed(bench, rig, disagreement=0.05)
    statuses: list[Any] = []
    bench.probe.create_subscription(DiagnosticArray, "/diagnostics", statuses.append, 100)
    person = Person(bench, rig)
    person.balance(200)
    rig.ask("faults", **fault)
    stops = bridge.guard.stops
    bench.spin(lambda: bridge.guard.stops > stops and not rig.status["armed"])
    assert rig.status["volts"] == 0.0
    said = bridge.guard.reason
    if reason:
        assert reason in said
    bench.spin(lambda: any(said == each.status[0].message for each in statuses))
    stopped = bridge.guard.stops
    bench.settle(0.2)
    assert bridge.guard.stops == stopped
    assert bridge.guard.reason == said
    assert rig.status["volts"] == 0.0
    rig.ask("faults", **{name: type(value)() for name, value in fault.items()})
    person.balance(200)


def test_small_faults_are_borne(bench: Bench, emulate: Any) -> None:
    """One frame in fifty lost, repeated or corrupt each: counted, and the pendulum stands."""
    rig = emulate("--fault", "lost=0.02", "--fault", "repeated=0.02", "--fault", "corrupt=0.02")
    bridge = composed(bench, rig, bad_frames=0.3)
    Person(bench, rig).balance(1500)
    host = bridge.connection.host
    assert min(host.lost, host.corrupt, host.repeated, host.refused) > 5


def test_a_line_that_breaks_comes_back(
    bench: Bench, processes: Any, emulate: Any, tmp_path: Path
) -> None:
    """The rig is unplugged and plugged in again: stopped, then reading, then armed by hand."""
    rig = emulate()
    bridge = composed(bench, rig)
    Person(bench, rig).balance(200)
    rig.process.kill()
    rig.process.wait()
    bench.spin(lambda: bridge.connection is None and not bridge.guard.armed)
    rig = emulate()
    bench.spin(lambda: bridge.connection is not None)
    Person(bench, rig).balance(200)
