"""A graph in lock-step in this process, with an intruder on its topics."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import Any

import numpy as np
from rcl_interfaces.msg import Log
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64

from furuta_graph.composed_graph import SimulatedGraph
from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, JOINT_STATES, MEASUREMENT, QOS, deep
from furuta_sim.settings.settings import load_settings
from soak.mutators import damaged_joint_state, joint_state, random_float
from soak.oracles import hanging_drive, not_recovered, out_of_bounds
from soak.record import Record

# Longest wait for a run or an answer [s].
WAIT = 30.0
TOPICS = (MEASUREMENT, JOINT_STATES, FRICTION_ESTIMATE, COMMAND)


class IntrudedGraph:
    """A graph in lock-step with an intruder, and what the plant and the controller published."""

    def __init__(self, record: Record, random: np.random.Generator, settings: list[str]) -> None:
        self.record, self.random = record, random
        self.settings = load_settings([], settings)
        self.settings["plant"] |= {"clock": "lockstep", "run_until": 0.0}
        self.intruder = Node("intruder")
        self._publishers = {t: self.intruder.create_publisher(t.type, t.name, QOS) for t in TOPICS}
        self.log: list[str] = []
        self.intruder.create_subscription(Log, "/rosout", self._keep_log, deep(1000))
        self.graph = SimulatedGraph(self.settings, others=[self.intruder])
        self.plant = self.graph.plant
        self.states: list[tuple[float, ...]] = []
        self.torques: list[float] = []
        self.commands = self.measurements = 0
        self._watch(self.plant, "ground_truth", self._keep_state)
        self._watch(self.plant, "measurement", self._keep_torque)
        self._watch(self.graph.node("controller"), "command", self._count)

    def _keep_log(self, message: Log) -> None:
        self.log.append(f"{message.name}: {message.msg}")

    def _keep_state(self, m: Any) -> None:
        self.states.append((m.position[0], m.velocity[0], m.position[1], m.velocity[1]))

    def _keep_torque(self, message: Any) -> None:
        self.measurements += 1
        if len(self.torques) < len(self.states):  # not a repetition
            self.torques.append(message.effort[0])

    def _count(self, message: Any) -> None:
        self.commands += 1

    @staticmethod
    def _watch(node: Any, topic: str, keep: Callable[[Any], None]) -> None:
        """Call ``keep`` with everything that the node publishes on a topic."""
        name = node.resolve_topic_name(topic)
        (publisher,) = (each for each in node.publishers if each.topic_name == name)
        publish = publisher.publish

        def watched(message: Any) -> None:
            keep(message)
            publish(message)

        publisher.publish = watched

    def spin(self, until: Callable[[], bool], seconds: float = WAIT) -> bool:
        """Spin until the condition holds; returns whether it does in time."""
        deadline = monotonic() + seconds
        while not until():
            if monotonic() > deadline:
                return False
            self.graph.executor.spin_once(timeout_sec=0.02)
        return True

    def advance(self, seconds: float) -> bool:
        """Run the plant for so long; returns whether it has done so."""
        goal = round(self.plant.time + seconds, 3)  # the plant's time is in samples
        self.plant.set_parameters([Parameter("run_until", value=goal)])
        done = self.spin(lambda: self.plant.time >= goal - 1e-9)
        self.record.check("recovery", not_recovered(done, f"run to {goal:g} s", WAIT))
        return done

    def publish(self, topic: Any, given: Any) -> None:
        """Publish a message of the intruder."""
        self.record.tried[f"{topic.name}: {given.kind}"] += 1
        self._publishers[topic].publish(given.message)

    def message(self, topic: Any) -> Any:
        """A random message for a topic."""
        if topic.type is Float64:
            return random_float(self.random)
        message = joint_state(self.random.normal(0, 0.1, 4), 0.0, int(self.plant.time * 1e9) + 1)
        return damaged_joint_state(self.random, message, sensors=topic is MEASUREMENT)

    def check_motion(self) -> None:
        """Bounds, and no drive while hanging."""
        x = np.array(self.states).reshape(-1, 4)
        self.record.check("bounds", out_of_bounds(x))
        torques = np.array(self.torques)
        self.record.check("hanging", hanging_drive(x[: len(torques), 2], torques, 0.001))


@contextmanager
def running(record: Record, random: np.random.Generator, *settings: str) -> Iterator[IntrudedGraph]:
    """A graph from its start to its end."""
    run = IntrudedGraph(record, random, list(settings))
    try:
        yield run
    finally:
        run.graph.close()
