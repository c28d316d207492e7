"""Campaign ``graph``: the graph in one process in lock-step, with an intruder on its topics.

Messages pass through the middleware. Messages that are refused must not change the run: it is that
of the simulation, to the last bit.
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from furuta_friction.compensation import COMPENSATIONS
from furuta_model.parameters import values
from furuta_ros.context import ros_context
from furuta_sim.settings.settings import loop
from furuta_sim.simulation.closed_loop import simulate
from soak.intruded_graph import TOPICS, WAIT, IntrudedGraph, running
from soak.mutators import pick, random_change
from soak.oracles import (
    changed_parameters,
    different_run,
    fallen,
    not_named,
    not_recovered,
    out_of_bounds,
    wrong_command_count,
    wrong_refusal,
)
from soak.record import Record
from soak.resources import ResourceMonitor

# Length of a run without effective intrusion [s].
EXACT = 1.0
# Samples over which commands are counted after a stray message.
COUNTED = 200


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
        record.check("one command", wrong_command_count(len(got), run.measurements, run.commands))


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
        counts = np.array([len(run.states), run.measurements, run.commands])
        run.advance(COUNTED * 0.001)
        added = np.array([len(run.states), run.measurements, run.commands]) - counts
        count = wrong_command_count(*added.tolist())
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


def _change(run: IntrudedGraph, client: Any, name: str, change: Any) -> None:
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


def _reset(run: IntrudedGraph, method: str) -> None:
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
    with ros_context():
        while record.next_step():
            scenario = pick(random, SCENARIOS)
            record.tried[f"run of {scenario.__name__}"] += 1
            scenario(record, random)
            watch.sample({"graph": os.getpid()})
