"""Campaign ``realtime_processes``: kills, pauses, messages and parameters for a graph in real time.

While the controller is dead or paused the simulated drive must go to 0 V, and the graph must
continue afterwards.
"""

from __future__ import annotations

import os
from pathlib import Path
from tempfile import TemporaryDirectory
from time import time_ns
from typing import Any

import numpy as np
from std_msgs.msg import Float64

from furuta_ros.context import ros_context
from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, JOINT_STATES, MEASUREMENT, QOS
from furuta_sim.settings.nodes import NODES, graph_nodes
from soak.mutators import damaged_joint_state, joint_state, pick, random_change, random_float
from soak.node_process import NodeProcess, end
from soak.observer import Observer, motion, newest_stamp, states
from soak.oracles import fallen, hanging_drive, not_recovered, out_of_bounds
from soak.record import Record
from soak.resources import ResourceMonitor

NAMES = [each.name for each in graph_nodes()]
TOPICS = (MEASUREMENT, JOINT_STATES, FRICTION_ESTIMATE, COMMAND)
# Samples that the graph must make after an intrusion, and the time for them [s].
SAMPLES, RECOVERY = 100, 60.0
# Time after which the drive must be at 0 V while no command comes [s], and the samples to look at.
# The timeout is 0.05 s; the rest is what a machine under load delays messages and the plant.
SILENT = 0.5
AT_ZERO = 20
STRAYS = 50


def run(record: Record, watch: ResourceMonitor) -> None:
    """Run the slice."""
    random = record.part.random()
    with ros_context(), TemporaryDirectory() as directory:
        graph = RealtimeProcesses(record, random, Path(directory))
        try:
            while record.next_step():
                graph.intrude()
                watch.sample({"realtime_processes": os.getpid()} | graph.pids)
        finally:
            graph.close()


class RealtimeProcesses:
    """A graph in real time, a process per node, with an intruder."""

    def __init__(self, record: Record, random: np.random.Generator, directory: Path) -> None:
        self._record, self._random = record, random
        self._observer = Observer()
        self._intruder = {
            topic: self._observer.node.create_publisher(topic.type, topic.name, QOS)
            for topic in TOPICS
        }
        self._nodes = {name: NodeProcess(name, directory) for name in NAMES}
        self._balance()

    @property
    def pids(self) -> dict[str, int]:
        """Process numbers by node."""
        return {name: each.process.pid for name, each in self._nodes.items()}

    def intrude(self) -> None:
        """One intrusion of a random kind, then the checks."""
        kind = pick(self._random, ("kill", "pause", "pause", "messages", "parameters"))
        getattr(self, f"_{kind}")()
        observer = self._observer
        moved = observer.spin(lambda: len(observer.truths) > SAMPLES, RECOVERY)
        self._record.check("recovery", not_recovered(moved, f"{SAMPLES} samples", RECOVERY))
        for each in self._nodes.values():
            each.check(self._record)
        self._check_motion()

    def _kill(self) -> None:
        name = str(pick(self._random, NAMES))
        node = self._nodes[name]
        self._record.tried[f"kill {name}"] += 1
        node.kill()
        if name != "plant":
            self._check_silence()
        node.start()
        self._observer.clear()

    def _pause(self) -> None:
        name = str(pick(self._random, NAMES))
        self._record.tried[f"pause {name}"] += 1
        self._nodes[name].pause(float(self._random.uniform(0.01, 1.0)))
        self._observer.clear()

    def _check_silence(self) -> None:
        """Without commands the plant applies 0 V; an observer is not needed for commands."""
        observer = self._observer
        if self._nodes["controller"].process.poll() is None and (
            self._nodes["estimator"].process.poll() is None
        ):
            return
        silent = time_ns() + round(SILENT * 1e9)
        observer.clear()
        # Messages that waited are dropped first: looking at all of them for each new one is slow.
        current = observer.spin(lambda: newest_stamp(observer.truths) > silent, RECOVERY)
        observer.clear()
        received = current and observer.spin(
            lambda: len(motion(observer, silent)) > AT_ZERO, RECOVERY
        )
        problem = not_recovered(received, f"{AT_ZERO} samples without commands", RECOVERY)
        driven = int(np.count_nonzero(motion(observer, silent)[:, 1]))
        problem = problem or (f"{driven} samples driven {SILENT:g} s later" if driven else "")
        self._record.check("watchdog", problem)

    def _messages(self) -> None:
        for _ in range(STRAYS):
            topic = pick(self._random, TOPICS)
            given = self._message(topic)
            self._record.tried[f"{topic.name}: {given.kind}"] += 1
            self._intruder[topic].publish(given.message)
        # The plant may be driven by a stray command until the next one, or until the timeout.
        self._observer.spin_for(0.3)
        self._observer.clear()

    def _message(self, topic: Any) -> Any:
        if topic.type is Float64:
            return random_float(self._random)
        x = self._random.normal(0, 0.2, 4)
        stamp = self._observer.node.get_clock().now().nanoseconds
        message = joint_state(x, 0.0, stamp)
        return damaged_joint_state(self._random, message, sensors=topic is MEASUREMENT)

    def _parameters(self) -> None:
        """Changes that must be refused, through the service."""
        name = str(pick(self._random, NAMES))
        change = random_change(self._random, NODES[name].parameters)
        if not change.refuse:
            return
        self._record.tried[f"parameters: {change.kind}"] += 1
        answer = self._observer.set(name, *change.parameters)
        waited = f"{name} answers" if answer else f"{name} answers; {self._observer.known_of(name)}"
        answered = not_recovered(answer is not None, waited, RECOVERY)
        if self._record.check("recovery", answered):
            refused = not answer.result.successful
            self._record.check("refusal", "" if refused else f"accepted {change.parameters}")
            self._record.refused["parameters"] += refused

    def _check_motion(self) -> None:
        x = states(self._observer.truths)
        self._record.check("bounds", out_of_bounds(x))
        for i, name in ((0, "arm angle [rad]"), (1, "arm speed [rad/s]")):
            self._record.measure(name, float(np.max(np.abs(x[:, i]), initial=0.0)))
        theta, volts = motion(self._observer).T
        self._record.check("hanging", hanging_drive(theta, volts, 0.001))
        if len(theta) and fallen(theta[-1]):
            self._record.tried["fall"] += 1
            self._balance()
        self._observer.clear()

    def _balance(self) -> None:
        """A reset; real time under load need not balance the pendulum, but usually does."""
        observer = self._observer
        self._record.tried["reset"] += 1
        observer.reset()
        observer.clear()
        observer.spin(lambda: len(observer.truths) > 1000, RECOVERY)
        x = states(observer.truths)
        upright = len(x) > 1000 and bool(np.all(np.abs(x[900:1000, 2]) < 0.5))
        self._record.tried["balanced after a reset"] += upright

    def close(self) -> None:
        """End all processes."""
        end(self._nodes.values(), self._record)
        self._observer.close()
