"""Campaign ``graph``: the graph in one process in lock-step, with an intruder on its topics.

Messages pass through the middleware. Messages that are refused must not change the run: it is that
of the simulation, to the last bit.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import Any

import numpy as np
from rcl_interfaces.msg import Log
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

from furuta_analysis.simulation.closed_loop import simulate
from furuta_graph.composed_graph import SimulatedGraph
from furuta_graph.settings import load_settings, loop
from furuta_model.parameters import values
from furuta_ros.context import ros_context
from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, JOINT_STATES, MEASUREMENT, QOS, deep
from soak.mutators import damaged_joint_state, joint_state, pick, random_change, random_float
from soak.oracles import (
    changed_parameters,
    different_run,
    fallen,
    hanging_drive,
    not_named,
    not_recovered,
    out_of_bounds,
    wrong_command_count,
    wrong_refusal,
)
from soak.record import Record
from soak.resources import ResourceMonitor

TOPICS = (MEASUREMENT, JOINT_STATES, FRICTION_ESTIMATE, COMMAND)
COMPENSATIONS = ("none", "coulomb", "stiction", "lugre", "adaptive")
# Length of a run without effective intrusion [s], and its wait in this machine's time.
EXACT, WAIT = 1.0, 30.0
# Samples over which commands are counted after a stray message.
COUNTED = 200


class Run:
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
        self.commands = 0
        self._watch(self.plant, "ground_truth", self._keep_state)
        self._watch(self.plant, "measurement", self._keep_torque)
        self._watch(self.graph.node("controller"), "command", self._count)

    def _keep_log(self, message: Log) -> None:
        self.log.append(f"{message.name}: {message.msg}")

    def _keep_state(self, m: Any) -> None:
        self.states.append((m.position[0], m.velocity[0], m.position[1], m.velocity[1]))

    def _keep_torque(self, message: Any) -> None:
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
def running(record: Record, random: np.random.Generator, *settings: str) -> Iterator[Run]:
    """A graph from its start to its end."""
    run = Run(record, random, list(settings))
    try:
        yield run
    finally:
        run.graph.close()


def refused_messages(record: Record, random: np.random.Generator) -> None:
    """Messages that must be refused: the run is that of the simulation."""
    compensation, seed = pick(random, COMPENSATIONS), int(random.integers(2**31))
    with running(record, random, f"compensation={compensation}", f"seed={seed}") as run:
        while run.plant.time < EXACT - 1e-9:
            for _ in range(int(random.integers(1, 20))):
                topic = pick(random, TOPICS)
                given = run.message(topic)
                if given.refuse:
                    run.publish(topic, given)
            if not run.advance(EXACT / 10):
                return
        expected = simulate(loop(run.settings), EXACT)
        got = np.array(run.states)
        numbers = list(range(len(got)))
        record.tried["compared samples"] += len(got)
        record.check("graph = simulation", different_run(numbers, got, expected.state))
        record.check("one command", wrong_command_count(len(got), run.commands))


def stray_messages(record: Record, random: np.random.Generator) -> None:
    """Plausible messages of a second publisher: it is named, and there is one command a sample."""
    with running(record, random) as run:
        run.advance(0.2)
        topic = pick(random, TOPICS)
        for _ in range(int(random.integers(1, 10))):
            given = run.message(topic)
            if not given.refuse:
                run.publish(topic, given)
        run.advance(0.2)
        named = run.spin(lambda: not not_named(topic.name, run.log), 3.0)
        record.check("named", "" if named else not_named(topic.name, run.log))
        samples, commands = len(run.states), run.commands
        run.advance(COUNTED * 0.001)
        count = wrong_command_count(len(run.states) - samples, run.commands - commands)
        after = f"after a stray message on {topic.name}: {count}"
        record.check("one command", after if count else "")
        record.check("bounds", out_of_bounds(np.array(run.states)))


def parameters_by_service(record: Record, random: np.random.Generator) -> None:
    """Random changes of every node through its service, while the graph runs."""
    with running(record, random) as run:
        clients = {
            node.get_name(): run.intruder.create_client(
                SetParametersAtomically, f"{node.get_name()}/set_parameters_atomically"
            )
            for node in run.graph.nodes[:-1]
        }
        run.plant.set_parameters([Parameter("run_until", value=1e9)])
        for _ in range(10):
            name = str(pick(random, list(clients)))
            change = random_change(random, type(run.graph.node(name).parameters))
            if name == "plant" and not change.refuse:
                continue  # another plant has other bounds
            _change(run, clients[name], name, change)
        moved = len(run.states)
        done = run.spin(lambda: len(run.states) > moved + 100)
        record.check("recovery", not_recovered(done, "100 samples", WAIT))
        record.check("bounds", out_of_bounds(np.array(run.states)))


def _change(run: Run, client: Any, name: str, change: Any) -> None:
    record, node = run.record, run.graph.node(name)
    record.tried[f"parameters: {change.kind}"] += 1
    before = values(node.parameters)
    request = SetParametersAtomically.Request()
    request.parameters = [each.to_parameter_msg() for each in change.parameters]
    run.spin(client.service_is_ready)
    future = client.call_async(request)
    answered = run.spin(future.done)
    if not record.check("recovery", not_recovered(answered, f"{name} answers", WAIT)):
        return
    refused = not future.result().result.successful
    given = [(each.name, each.value) for each in change.parameters]
    record.check("refusal", wrong_refusal(change.refuse, refused, given))
    if refused:
        record.refused["parameters"] += 1
        record.check("unchanged", changed_parameters(before, values(node.parameters)))


def falls(record: Record, random: np.random.Generator) -> None:
    """The pendulum falls, is not driven while it hangs, and a reset balances it again."""
    method = pick(random, ("kalman", "lowpass"))
    with running(record, random, f"estimator.method={method}") as run:
        run.advance(0.5)
        controller = run.graph.node("controller")
        for _ in range(3):
            controller.set_parameters([Parameter("enabled", value=False)])
            run.advance(float(random.uniform(0.5, 4.0)))
            controller.set_parameters([Parameter("enabled", value=True)])
            run.advance(float(random.uniform(0.0, 3.0)))
            record.tried["fall"] += fallen(run.plant.x[2])
            run.check_motion()
            _reset(run, method)


def _reset(run: Run, method: str) -> None:
    client = run.intruder.create_client(Trigger, "plant/reset")
    run.spin(client.service_is_ready)
    future = client.call_async(Trigger.Request())
    run.spin(future.done)
    run.record.tried["reset"] += 1
    begun = len(run.states)
    run.advance(3.0)
    upright = np.abs(np.array(run.states)[begun + 2000 :, 2]) < 0.3
    balanced = len(upright) > 0 and bool(np.all(upright))
    run.record.check("recovery", not_recovered(balanced, f"balanced after a reset, {method}", 3.0))
    run.states.clear()
    run.torques.clear()


SCENARIOS = (refused_messages, stray_messages, parameters_by_service, falls)


def run(record: Record, watch: ResourceMonitor) -> None:
    """Run the slice."""
    random = record.part.random()
    deadline = monotonic() + record.part.seconds
    with ros_context():
        while monotonic() < deadline:
            record.step += 1
            scenario = pick(random, SCENARIOS)
            record.tried[f"run of {scenario.__name__}"] += 1
            scenario(record, random)
            watch.sample({"graph": os.getpid()})
