"""The whole graph on a rig that speaks real bytes over a pseudo-terminal, in its own process."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic, monotonic_ns
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.parameter import Parameter
from std_srvs.srv import SetBool
from testbench import Bench

from furuta_analysis.simulation.closed_loop import simulate
from furuta_control.controller_node import ControllerNode
from furuta_control.estimator_node import EstimatorNode
from furuta_friction.friction_observer_node import FrictionObserverNode
from furuta_graph.description import HARDWARE_BRIDGE, graph_nodes
from furuta_graph.settings import load_settings, loop
from furuta_hw.bridge_node import HardwareBridgeNode
from furuta_hw.rig import Rig
from furuta_ros.topics import COMMAND, MEASUREMENT

pytestmark = pytest.mark.realtime

RIG = Rig()
PERIOD = 1_000_000
WATCHDOG = RIG.watchdog_samples * PERIOD
SETTLING = 500  # samples between putting the pendulum up and letting it go
# Rounds of kills; more of them on demand, for they take their time.
ROUNDS = int(os.environ.get("FURUTA_KILL_ROUNDS", "1"))
VICTIMS = ("hardware_bridge", "controller", "estimator", "friction_observer")


@contextmanager
def load() -> Iterator[None]:
    """Every core busy, with what gives way to a loop but does not go away."""
    burners = [
        subprocess.Popen([sys.executable, "-c", "import os; os.nice(5)\nwhile True: pass"])
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
        end = monotonic() + 2.0
        self._bench.spin(lambda: future.done() or monotonic() > end)
        if not future.done():
            return False, "no answer"
        return future.result().success, future.result().message

    def balance(self, samples: int = 500) -> None:
        """Hold, arm, let go, until the rig has been driven upright for so many samples.

        A stall of the machine may stop it meanwhile, as it must: then again.
        """
        end = monotonic() + 90.0
        while not self._balanced(samples):
            assert monotonic() < end, "the rig was never driven for so long"

    def _balanced(self, samples: int) -> bool:
        """Hold and wait as an operator would, until filters have settled; then one attempt."""
        rig, held = self._rig, self._rig.ask("hold")
        # A bridge that connects meanwhile has the rig count anew.
        self._bench.spin(lambda: not 0 <= rig.status["sample"] - held["sample"] <= SETTLING)
        if not self.arm()[0]:
            return False
        begun, end = held["driven"], monotonic() + 3.0 + 0.003 * samples

        def over() -> bool:
            stopped = rig.status["driven"] > begun and not rig.status["armed"]
            return stopped or rig.status["driven"] > begun + samples or monotonic() > end

        self._bench.spin(over, timeout=90.0)
        upright = abs(rig.status["state"][2]) < 0.2
        return bool(rig.status["armed"] and rig.status["driven"] > begun + samples and upright)


def composed(bench: Bench, rig: Any, compensation: str = "none", **limits: float) -> Any:
    """The graph in this process; the bridge, active."""
    rig_file = rig.port.parent / "rig.yaml"
    rig_file.write_text(f"limits: {limits}")
    bridge = bench.add(
        HardwareBridgeNode(
            [
                Parameter("port", value=str(rig.port)),
                Parameter("rig", value=str(rig_file)),
                Parameter("autostart", value="active"),
            ]
        )
    )
    bench.add(EstimatorNode())
    bench.add(FrictionObserverNode([Parameter("compensation", value=compensation)]))
    bench.add(ControllerNode())
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
    first = armed[0] + 100  # after the slew limit has let go of the first command
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
    """Arm's travel over 5 s of the rig's time is one of those that the simulation has, to 10 %.

    Without compensation they are all alike; what LuGre compensation leaves is below one count of
    the encoder and varies from one 5 s to the next by half. benchmarks/hardware.py runs longer.
    """
    rig = emulate("--lockstep")
    bridge = composed(bench, rig, compensation, **PATIENT)
    Person(bench, rig).balance(100)
    begun = rig.status["sample"]
    bench.spin(lambda: rig.status["sample"] > begun + 11_000, 120.0)
    phi = rig.trace(tmp_path / "trace.npz")
    assert bridge.guard.stops == 0
    got = np.ptp(phi["phi"][phi["armed"] > 0][5_000:10_000])
    record = simulate(loop(load_settings([], [f"compensation={compensation}"])), 205.0)
    travels = [np.ptp(window) for window in np.split(record.state[5_000:, 0], 40)]
    assert 0.9 * min(travels) < got < 1.1 * max(travels)


def test_real_time_stabilises(bench: Bench, emulate: Any) -> None:
    """At 1 kHz the pendulum stands, and nearly every sample is answered."""
    rig = emulate()
    composed(bench, rig)
    Person(bench, rig).balance(2000)
    assert abs(rig.status["state"][2]) < 0.2


def test_kill_nine_of_each_node(bench: Bench, processes: Any, emulate: Any, tmp_path: Path) -> None:
    """Under load: 0 V within the watchdog's period every time, and the loop comes back."""
    rig = emulate()
    start = {
        name: (f"port:={rig.port}", "autostart:=active") if name == HARDWARE_BRIDGE else ()
        for name, *_ in graph_nodes(HARDWARE_BRIDGE)
    }
    running = {name: processes.node(name, *start[name]) for name in start}
    node = Person(bench, rig)
    with load():
        for _ in range(ROUNDS):
            for name in VICTIMS:
                node.balance(100)
                running[name].send_signal(signal.SIGKILL)
                running[name].wait()
                dead = monotonic_ns()
                bench.spin(lambda dead=dead: monotonic_ns() > dead + 5 * WATCHDOG)
                trace = rig.trace(tmp_path / "trace.npz")
                after = trace["time_ns"] > dead + WATCHDOG + PERIOD
                assert np.any(trace["volts"][~after][-2000:] != 0.0), name
                assert np.all(trace["volts"][after] == 0.0), name
                running[name] = processes.node(name, *start[name])
        node.balance(100)


def test_bridge_ends_cleanly(bench: Bench, processes: Any, emulate: Any) -> None:
    """SIGINT, SIGTERM: status 0, no traceback, 0 V by the bridge itself, not by the watchdog."""
    rig = emulate()
    bench.add(EstimatorNode())
    bench.add(FrictionObserverNode())
    bench.add(ControllerNode())
    node = Person(bench, rig)
    for number in (signal.SIGINT, signal.SIGTERM):
        bridge = processes.node("hardware_bridge", f"port:={rig.port}", "autostart:=active")
        node.balance(100)
        bridge.send_signal(number)
        bench.spin(lambda bridge=bridge: bridge.poll() is not None)
        _, err = bridge.communicate(timeout=30.0)
        assert bridge.returncode == 0, err
        assert "Traceback" not in err
        bench.spin(lambda: not rig.status["armed"])
        assert (rig.status["volts"], rig.status["tripped"]) == (0.0, False)


FAULTS: list[tuple[dict[str, Any], str]] = [
    ({"lost": 0.6}, "lost or corrupt"),
    ({"corrupt": 0.6}, "lost or corrupt"),
    ({"silent": True}, "no measurement"),
    ({"late": 200}, ""),
    ({"potentiometer_rail": True}, "end of its range"),
    ({"encoder_stuck": True}, ""),
    ({"rig_fault": True}, "the rig reports a fault"),
]


def test_faults_stop_it_once_with_a_reason(bench: Bench, emulate: Any) -> None:
    """0 V on both sides, one edge, the reason on /diagnostics; it runs again when re-armed."""
    rig = emulate()
    bridge = composed(bench, rig, disagreement=0.05)
    statuses: list[Any] = []
    bench.probe.create_subscription(DiagnosticArray, "/diagnostics", statuses.append, 100)
    node = Person(bench, rig)
    for fault, reason in FAULTS:
        node.balance(100)
        statuses.clear()
        stops = bridge.guard.stops
        rig.ask("faults", **fault)
        bench.spin(lambda stops=stops: bridge.guard.stops > stops and not rig.status["armed"])
        assert rig.status["volts"] == 0.0
        said = bridge.guard.reason
        assert reason in said
        bench.spin(lambda said=said: any(said == each.status[0].message for each in statuses))
        bench.settle(0.2)
        assert (bridge.guard.stops, bridge.guard.reason) == (stops + 1, said)
        assert rig.status["volts"] == 0.0
        rig.ask("faults", **{name: type(value)() for name, value in fault.items()})
    node.balance(100)


def test_small_faults_are_borne(bench: Bench, emulate: Any) -> None:
    """One frame in fifty lost, repeated or corrupt each: counted, and the pendulum stands."""
    rig = emulate("--fault", "lost=0.02", "--fault", "repeated=0.02", "--fault", "corrupt=0.02")
    bridge = composed(bench, rig, bad_frames=0.3)
    Person(bench, rig).balance(1000)
    host = bridge.connection.host
    assert min(host.lost, host.corrupt, host.repeated, host.refused) > 5


def test_a_line_that_breaks_comes_back(
    bench: Bench, processes: Any, emulate: Any, tmp_path: Path
) -> None:
    """The rig is switched off and on, or unplugged: stopped, then reading, then armed by hand."""
    rig = emulate()
    bridge = composed(bench, rig)
    Person(bench, rig).balance(100)
    rig.ask("reboot")
    bench.spin(lambda: not bridge.guard.armed)
    samples = bridge.samples
    bench.spin(lambda: bridge.samples > samples + 100)
    Person(bench, rig).balance(100)
    rig.process.kill()
    rig.process.wait()
    bench.spin(lambda: bridge.connection is None and not bridge.guard.armed)
    rig = emulate()
    bench.spin(lambda: bridge.connection is not None)
    Person(bench, rig).balance(200)
