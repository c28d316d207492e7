"""Campaign ``rig``: the graph of processes on an emulated rig behind a pseudo-terminal.

Kills and pauses of the bridge and of every other node, faults of the line, and messages and floods
of a second publisher. The log of the emulated rig shows when it was driven; it does not depend on
the graph.
"""

import subprocess
from collections.abc import Iterable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic, monotonic_ns, sleep
from typing import Any

import flood
import numpy as np
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from std_srvs.srv import SetBool

from furuta_graph.processes import executable
from furuta_graph.settings.nodes import (
    CONTROLLER,
    ESTIMATOR,
    FRICTION_OBSERVER,
    HARDWARE_BRIDGE,
    graph_nodes,
)
from furuta_hw.emulator.emulated_rig import plant_of
from furuta_hw.emulator.monitor import ask
from furuta_hw.rigs.rig import Rig
from furuta_ros.context import ros_context
from furuta_ros.node import MAX_AGE
from furuta_ros.topics import COMMAND, QOS
from furuta_sim.plant import design_plant
from soak.mutators import pick, random_float
from soak.node_process import NodeProcess, end, flood_commands
from soak.observer import Observer
from soak.oracles import (
    applied,
    armed_without_request,
    different_motion,
    energy_growth,
    late_stop,
    out_of_bounds,
    unanswered_drive,
    unarmed_drive,
)
from soak.record import Record
from soak.resources import ResourceMonitor

RIG = Rig()
PERIOD = round(RIG.line.sample_time * 1e9)
# Time from the last sign of life to 0 V that is allowed: the watchdog, and a sample [ns].
ALLOWED = (RIG.watchdog_samples + 1) * PERIOD
# Without friction observer the commands go on until the bridge's guard stops them.
ESTIMATE_AGE = round(RIG.limits.estimate_age * 1e9)
# The last message of a node may be under way for MAX_AGE, and then that of its receiver.
UNDER_WAY = round(MAX_AGE * 1e9)
ALLOWED_BY_NODE = {
    HARDWARE_BRIDGE: ALLOWED,
    CONTROLLER: ALLOWED + UNDER_WAY,
    FRICTION_OBSERVER: ALLOWED + UNDER_WAY + ESTIMATE_AGE,
    ESTIMATOR: ALLOWED + 2 * UNDER_WAY,
}
NAMES = [each.name for each in graph_nodes(HARDWARE_BRIDGE)]
SETTLING = 0.6  # [s] between holding the pendulum upright and arming
DRIVEN = 100  # samples driven before an intrusion
# Time to drive it [s]: the successor of a killed node waits until that is no longer listed.
PATIENCE = 90.0
KINDS = ("kill", "kill", "pause", "pause", "fault", "messages", "services", "flood")
INTRUSIONS = 20  # between two looks at the log
FAULTS: tuple[dict[str, Any], ...] = (
    {"lost": 0.6},
    {"lost": 0.02},
    {"corrupt": 0.6},
    {"corrupt": 0.02},
    {"repeated": 0.5},
    {"late": 200},
    {"silent": True},
    {"encoder_stuck": True},
    {"potentiometer_rail": True},
    {"rig_fault": True},
)


def run(record: Record, watch: ResourceMonitor) -> None:
    """Run the slice."""
    random = record.part.random()
    with ros_context(), TemporaryDirectory() as directory:
        graph = RigGraph(record, random, Path(directory))
        try:
            while record.next_step():
                graph.intrude()
                watch.sample(graph.pids)  # this process keeps the log
                if record.step % INTRUSIONS == 0:
                    graph.check_log()
            graph.check_log()
        finally:
            graph.close()


class RigGraph:
    """An emulated rig in a process, and a graph that drives it."""

    def __init__(self, record: Record, random: np.random.Generator, directory: Path) -> None:
        self._record, self._random, self._directory = record, random, directory
        self._monitor = directory / "monitor"
        self._emulator = subprocess.Popen(
            [
                *(str(executable("furuta_hw", "rig_emulator")), "--link", str(directory / "port")),
                *("--monitor", str(self._monitor)),
            ],
            stdout=subprocess.PIPE,
        )
        assert self._emulator.stdout is not None
        self._emulator.stdout.readline()
        self._observer = Observer()
        bridge = (f"port:={directory / 'port'}", "autostart:=active")
        self._nodes = {
            name: NodeProcess(name, directory, *(bridge if name == HARDWARE_BRIDGE else ()))
            for name in NAMES
        }
        self.requests = 0
        self._silences: list[tuple[str, int, int]] = []

    @property
    def pids(self) -> dict[str, int]:
        """Process numbers by node. The emulator's memory grows with its log."""
        return {name: each.process.pid for name, each in self._nodes.items()}

    def intrude(self) -> None:
        """Drive the rig, then disturb it in a random way."""
        deadline = monotonic() + PATIENCE
        while not self._drive() and monotonic() < deadline:
            pass
        kind = pick(self._random, KINDS)
        getattr(self, f"_{kind}")()
        for each in self._nodes.values():
            each.check(self._record)

    def _status(self) -> dict[str, Any]:
        return ask(self._monitor, "status")

    def _drive(self) -> bool:
        """Hold the pendulum upright, arm, and wait until the rig is driven."""
        begun = ask(self._monitor, "hold")["driven"]
        self._observer.spin_for(SETTLING)
        before = self._observer.requests
        answer = self._observer.call(SetBool, "hardware_bridge/arm", SetBool.Request(data=True))
        self.requests += self._observer.requests - before
        if answer is None or not answer.success:
            return False
        deadline = monotonic() + 2.0
        while monotonic() < deadline:
            status = self._status()
            if status["driven"] > begun + DRIVEN:
                return bool(status["armed"])
            sleep(0.02)
        return False

    def _kill(self) -> None:
        name = str(pick(self._random, NAMES))
        dead = self._nodes[name].kill()
        sleep(2 * max(ALLOWED_BY_NODE.values()) / 1e9)
        self._silences.append((name, dead, monotonic_ns()))
        self._nodes[name].start()

    def _pause(self) -> None:
        node = self._nodes[str(pick(self._random, NAMES))]
        self._silences.append((node.name, *node.pause(float(self._random.uniform(0.01, 0.5)))))

    def _fault(self) -> None:
        """A fault that the emulated rig has by itself."""
        fault = pick(self._random, FAULTS)
        ask(self._monitor, "faults", **fault)
        sleep(float(self._random.uniform(0.05, 0.4)))
        ask(self._monitor, "faults", **{name: type(value)() for name, value in fault.items()})

    def _messages(self) -> None:
        """Commands of a second publisher: they must not arm the rig."""
        node = self._observer.node
        intruder = node.create_publisher(COMMAND.type, COMMAND.name, QOS)
        self._observer.spin_for(0.2)
        for _ in range(50):
            intruder.publish(random_float(self._random).message)
        self._observer.spin_for(0.1)
        node.destroy_publisher(intruder)

    def _flood(self) -> None:
        """Commands of a publisher that never sleeps for long."""
        flood_commands(self._random)

    def _services(self) -> None:
        """Disarm, or leave the active state and return."""
        self._observer.call(SetBool, "hardware_bridge/arm", SetBool.Request(data=False))
        if self._random.random() < 0.5:
            return
        for number in (
            Transition.TRANSITION_DEACTIVATE,
            Transition.TRANSITION_CLEANUP,
            Transition.TRANSITION_CONFIGURE,
            Transition.TRANSITION_ACTIVATE,
        ):
            request = ChangeState.Request(transition=Transition(id=number))
            self._observer.call(ChangeState, "hardware_bridge/change_state", request)

    def check_log(self) -> None:
        """Check everything that the rig has done since its start."""
        log = self._log()
        if len(log["time_ns"]):  # otherwise the rig has not moved yet
            check_rig_log(self._record, log, self.requests, self._silences)
        self._silences.clear()

    def _log(self) -> dict[str, np.ndarray]:
        file = self._directory / "log.npz"
        ask(self._monitor, "save", path=str(file))
        with np.load(file) as table:
            return dict(table)

    def close(self) -> None:
        """End all processes."""
        end(self._nodes.values(), self._record)
        self._observer.close()
        self._emulator.terminate()
        self._emulator.wait()


def check_rig_log(
    record: Record,
    log: Mapping[str, np.ndarray],
    requests: int,
    silences: Iterable[tuple[str, int, int]],
) -> None:
    """Check a log from its begin, with the number of requests to arm.

    ``silences`` are nodes, and the times [ns] from which and until which they were dead or paused.
    """
    time, volts, armed = log["time_ns"], log["volts"], log["armed"]
    x = np.column_stack([log[name] for name in ("phi", "phi_dot", "theta", "theta_dot")])
    record.check("unarmed", unarmed_drive(volts, armed, requests))
    answers = unanswered_drive(volts, log["sample"], log["answered"], RIG.watchdog_samples)
    record.check("answers", answers)
    record.check("arming", armed_without_request(armed, requests))
    record.check("bounds", out_of_bounds(x))
    record.check("stranger", applied(volts, flood.VOLTS, 0.005))
    _check_physics(record, x, volts)
    for name, silent, back in silences:
        problem = late_stop(time, volts, silent, back, ALLOWED_BY_NODE[name])
        record.check("watchdog", f"{name}: {problem}" if problem else "")


def _check_physics(record: Record, x: np.ndarray, volts: np.ndarray) -> None:
    """The voltage of a row was applied up to its state."""
    held = np.all(x == x[0], axis=1)
    # Holding the pendulum moves it by hand.
    moved = held | np.append(held[1:], True)
    after = np.where(moved, 1.0, np.append(volts[1:], 0.0))
    record.check("energy", energy_growth(x, after, RIG.model, RIG.friction))
    plant = plant_of(RIG)
    record.check("rig = simulation", different_motion(x, volts, design_plant(plant), plant))
