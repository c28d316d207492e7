"""Campaign ``messages``: random messages and parameters for single nodes, by direct calls.

The callbacks of real nodes are called without the middleware: thousands of messages per second.
Each node has a twin that receives only what must not be refused. Both must publish the same, to the
last bit.
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from furuta_control.controller_node import ControllerNode
from furuta_control.estimator_node import EstimatorNode
from furuta_friction.compensation import design_compensator, largest_estimate
from furuta_friction.friction_observer_node import FrictionObserverNode
from furuta_model.parameters import values
from furuta_ros.context import ros_context
from furuta_sim.simulation.closed_loop import Loop, simulate
from soak.mutators import (
    Given,
    damaged_joint_state,
    default_values,
    joint_state,
    pick,
    random_change,
    random_float,
)
from soak.oracles import (
    bad_output,
    beyond_friction_limit,
    changed_parameters,
    different_value,
    wrong_refusal,
)
from soak.record import Record
from soak.resources import ResourceMonitor
from soak.subject import Subject

PERIOD = 1_000_000  # between two samples [ns]
# Shares of the steps that damage a message, and that change parameters.
DAMAGED, CHANGED = 0.5, 0.02
# Share of the changes that set all parameters to their defaults. Nodes are not made anew for that,
# because the middleware keeps some memory of each node that has ended.
RESTORED = 0.1
INPUTS = {
    EstimatorNode: ("measurement",),
    FrictionObserverNode: ("joint_states",),
    ControllerNode: ("joint_states", "friction_estimate"),
}


class Pair:
    """A node under test and its twin, with the stream of valid messages for both."""

    def __init__(self, node_class: Any, record: Record, random: np.random.Generator) -> None:
        self._record, self._random = record, random
        self._class = node_class
        self.node, self._twin = Subject(node_class), Subject(node_class)
        self._stream = _stream()
        self._sample = int(random.integers(len(self._stream)))
        self._stamp = self._sample * PERIOD
        self._strays = 0

    def step(self) -> None:
        """One random choice."""
        choice = self._random.random()
        if choice < CHANGED:
            self._change()
        elif choice < CHANGED + DAMAGED:
            topic = pick(self._random, INPUTS[self._class])
            self._give(topic, self._damaged(topic))
        else:
            self._give_sample()

    def anew(self) -> Pair:
        """End both nodes and make new ones."""
        self.close()
        return Pair(self._class, self._record, self._random)

    def close(self) -> None:
        """End both nodes."""
        for each in (self.node, self._twin):
            each.node.destroy_node()

    def _give_sample(self) -> None:
        self._sample = (self._sample + 1) % len(self._stream)
        self._stamp += PERIOD
        for topic in INPUTS[self._class]:
            message = Float64(data=0.1) if topic == "friction_estimate" else self._valid()
            self._give(topic, Given(message, "valid", False))

    def _valid(self) -> JointState:
        row = self._stream[self._sample]
        return joint_state(row, float(row[4]), self._stamp)

    def _stray(self) -> JointState:
        """A message between two samples: one with the stamp of a sample would count as repeated."""
        message = self._valid()
        self._strays += 1
        message.header.stamp.nanosec += self._strays % PERIOD
        return message

    def _damaged(self, topic: str) -> Given:
        if topic == "friction_estimate":
            return random_float(self._random)
        return damaged_joint_state(self._random, self._stray(), sensors=topic == "measurement")

    def _give(self, topic: str, given: Given) -> None:
        record = self._record
        try:
            refused, published = self.node.give(topic, given.message)
        except Exception as error:
            record.check("survival", f"{topic}, {given.kind}: {type(error).__name__}: {error}")
            return
        record.check("survival", "")
        record.check("refusal", wrong_refusal(given.refuse, refused, (topic, given.message)))
        if refused:
            record.check("twin", different_value(published, []))
            return
        _, expected = self._twin.give(topic, given.message)
        record.check("twin", different_value(published, expected))
        self._check_outputs(given, published)

    def _check_outputs(self, given: Given, published: list[tuple[float, ...]]) -> None:
        """Commands and friction estimates within their limits; estimates of states are finite."""
        parameters = self.node.node.parameters
        for out in published:
            if self._class is ControllerNode:
                self._record.check("output", bad_output(out[0], parameters.voltage_limit))
            elif self._class is FrictionObserverNode:
                # A repeated stamp repeats the estimate of an earlier speed.
                v = given.message.velocity[0] if given.kind == "valid" else np.inf
                limit = largest_estimate(float(v), design_compensator(parameters))
                self._record.check("output", bad_output(out[0], np.inf))
                if given.kind == "valid":
                    problem = beyond_friction_limit(out[0], limit)
                    self._record.check("friction limit", problem)
            else:
                for value in out[:4]:
                    known = 0.0 if np.isnan(value) else value
                    self._record.check("output", bad_output(known, np.inf))

    def _change(self) -> None:
        record, node = self._record, self.node.node
        change = random_change(self._random, type(node.parameters))
        if self._random.random() < RESTORED:
            change = default_values(type(node.parameters))
        before = values(node.parameters)
        given = [(each.name, each.value) for each in change.parameters]
        try:
            refused, _ = self.node.change(change)
        except Exception as error:
            record.check("survival", f"set {given}: {type(error).__name__}: {error}")
            return
        record.check("survival", "")
        record.check("refusal", wrong_refusal(change.refuse, refused, given))
        if refused:
            record.check("unchanged", changed_parameters(before, values(node.parameters)))
        else:
            self._twin.change(change)


def _stream() -> np.ndarray:
    """Measurements of a run (n, 5): true state, then the torque applied [V]."""
    run = simulate(Loop(), 5.0)
    return np.column_stack((run.state, np.concatenate(([0.0], run.command[:-1]))))


def run(record: Record, watch: ResourceMonitor) -> None:
    """Run the slice."""
    random = record.part.random()
    with ros_context():
        pairs = [Pair(each, record, random) for each in INPUTS]
        while record.next_step():
            chosen = int(random.integers(len(pairs)))
            broken = record.broken.total()
            pairs[chosen].step()
            # A broken oracle must not be counted again by what follows from it.
            if record.broken.total() > broken:
                pairs[chosen] = pairs[chosen].anew()
            watch.sample({"messages": os.getpid()})
        for each in pairs:
            each.close()
