"""Random messages and parameters for single nodes, by direct calls of their callbacks.

Each node has a twin that receives only what the node has accepted. Both must publish the same, to
the last bit. ``make soak`` tries longer.
"""

from functools import cache
from math import inf, isfinite, isnan, nan
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, rule
from part_parameters import largest_estimate
from rclpy.exceptions import ParameterNotDeclaredException
from rclpy.parameter import Parameter
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState
from soak_settings import run
from std_msgs.msg import Float64

from furuta_control.controller_node import ControllerNode
from furuta_control.estimator_node import EstimatorNode
from furuta_friction.friction_observer_node import FrictionObserverNode
from furuta_model.parameters import Declared, declared, values
from furuta_ros.testing import joint_state
from furuta_sim.simulation.closed_loop import Loop, simulate

INPUTS = {
    EstimatorNode: ("measurement",),
    FrictionObserverNode: ("joint_states",),
    ControllerNode: ("joint_states", "friction_estimate"),
}
PERIOD = 1_000_000  # between two samples [ns]
NO_INFO = {"source_timestamp": 0}
NOT_FINITE = st.sampled_from((nan, inf, -inf))
IMPOSSIBLE = NOT_FINITE | st.sampled_from((1e300, -1e300, 1e30, -1e20))
WRONG_TYPE = ("0.1", True, 7, [0.1], [b"\x01"], ["a"])


class Subject:
    """A node whose callbacks are called directly, and what it has published."""

    def __init__(self, kind: Any) -> None:
        self.published: list[tuple[float, ...]] = []
        with patch("furuta_ros.node.sender", self._sender):
            self.node = kind()
        self._callbacks = {each.topic_name: each.callback for each in self.node.subscriptions}

    def _sender(self, publisher: Any) -> Any:
        return lambda data: self._keep(deserialize_message(data, publisher.msg_type))

    def _keep(self, message: Any) -> None:
        arrays = (message.position, message.velocity) if hasattr(message, "position") else ()
        self.published.append(tuple(v for array in arrays for v in array) or (message.data,))

    def give(self, topic: str, data: bytes) -> tuple[bool, list[tuple[float, ...]]]:
        """Give a message; returns whether it was refused, and what was published."""
        self.published = []
        refused = self.node.refused
        self._callbacks[f"/{topic}"](data, NO_INFO)
        assert not [kind for kind in self.node._warned_at if kind.startswith("failed")]
        return self.node.refused > refused, self.published

    def change(self, given: dict[str, Any]) -> bool:
        """Change parameters as the service does; returns whether it was refused."""
        parameters = [Parameter(name, value=value) for name, value in given.items()]
        try:
            return not self.node.set_parameters_atomically(parameters).successful
        except ParameterNotDeclaredException:  # the service refuses then
            return True


def valid_value(each: Declared) -> Any:
    """A strategy for values of a parameter, most of them allowed."""
    about = each.about
    if about.choices:
        return st.sampled_from(about.choices)
    if each.kind is list:
        return st.lists(st.floats(-20.0, 20.0), min_size=4, max_size=4)
    if each.kind in (bool, str):
        return st.booleans() if each.kind is bool else st.just(each.default)
    low, high = max(about.low, -100.0), min(about.high, 100.0)
    if each.kind is int:
        return st.integers(int(low), int(high))
    near = st.floats(0.5, 2.0).map(lambda factor: min(max(each.default * factor, low), high))
    return near | st.floats(low, high)


def bad_value(each: Declared) -> Any:
    """A strategy for values that a parameter, a number, must not have."""
    about = each.about
    outside = [b for b in (about.low - 1.0, about.high * 2 + 1) if isfinite(b)]
    return NOT_FINITE | st.sampled_from((*WRONG_TYPE, *outside))


@cache
def stream() -> np.ndarray:
    """Measurements of a run (n, 5): true state, then the torque applied [V]."""
    run = simulate(Loop(), 5.0)
    return np.column_stack((run.state, np.concatenate(([0.0], run.command[:-1]))))


class Nodes(RuleBasedStateMachine):
    """A node and its twin; the rules give them samples, bad messages and parameters."""

    def __init__(self, kind: Any) -> None:
        super().__init__()
        self.kind, self.node, self.twin = kind, Subject(kind), Subject(kind)
        self.known = [e for e in declared(type(self.parameters)) if not e.about.read_only]
        self.sample = self.strays = 0

    def teardown(self) -> None:
        """End both nodes."""
        for each in (self.node, self.twin):
            each.node.destroy_node()

    @property
    def parameters(self) -> Any:
        """The parameters of the node."""
        return self.node.node.parameters

    def message(self, stray: bool) -> JointState:
        """A valid message, of this sample or between two: a repeated stamp means a repetition."""
        *x, effort = stream()[self.sample % len(stream())].tolist()
        self.strays += stray
        stamp = self.sample * PERIOD + stray * self.strays % PERIOD
        return joint_state(tuple(x), stamp, effort=effort)

    def give(
        self, topic: str, message: Any, refuse: bool | None = None, both: bool = False
    ) -> list[tuple[float, ...]]:
        """Give a message to the node; to the twin if it is accepted, or to ``both``.

        Returns what it publishes. ``refuse`` is whether it must be refused; None: both are right.
        """
        data = message if isinstance(message, bytes) else serialize_message(message)
        refused, published = self.node.give(topic, data)
        assert refuse in (None, refused), message
        expected = self.twin.give(topic, data)[1] if both or not refused else []
        assert repr(published) == repr(expected)
        limit = self.parameters.voltage_limit if self.kind is ControllerNode else inf
        unknown = self.kind is EstimatorNode  # may be published as NaN
        for value in (value for message in published for value in message):
            assert (isfinite(value) and abs(value) <= limit) or (unknown and isnan(value))
        return published

    @rule(count=st.integers(1, 20))
    def samples(self, count: int) -> None:
        """So many samples of the run."""
        for _ in range(count):
            self.sample += 1
            message = self.message(stray=False)
            for topic in INPUTS[self.kind]:
                self.give(topic, Float64(data=0.1) if "friction" in topic else message, False)
            if self.kind is FrictionObserverNode:
                v = float(message.velocity[0])
                limit = largest_estimate(v, self.parameters.observer)
                assert abs(self.node.published[0][0]) <= limit * (1.0 + 1e-9)

    @rule(
        field=st.sampled_from(("position", "velocity")), index=st.integers(0, 1), value=IMPOSSIBLE
    )
    def impossible_value(self, field: str, index: int, value: float) -> None:
        """A reading is replaced; an estimate may be unknown (NaN)."""
        message = self.message(stray=True)
        getattr(message, field)[index] = value
        is_unknown = self.kind is EstimatorNode or isnan(value)
        if self.kind is not ControllerNode:
            self.give(INPUTS[self.kind][0], message, not is_unknown)
            return
        answers = [  # a state is refused when it is answered
            *self.give("joint_states", message, both=True),
            *self.give("friction_estimate", Float64(data=0.1), both=True),
        ]
        assert is_unknown or not answers
        self.samples(1)

    @rule(
        field=st.sampled_from(("position", "velocity", "effort")), size=st.sampled_from((1, 3, 50))
    )
    def wrong_length(self, field: str, size: int) -> None:
        """An array with too few or too many elements."""
        message = self.message(stray=True)
        setattr(message, field, [0.1] * size)
        self.give(INPUTS[self.kind][0], message, True)

    @rule(names=st.lists(st.sampled_from(("arm", "pendulum", "leg", "", "é")), max_size=3))
    def other_names(self, names: list[str]) -> None:
        """Joints that are not both of the pendulum's."""
        message = self.message(stray=True)
        message.name = names
        self.give(
            INPUTS[self.kind][0], message, None if set(names) >= {"arm", "pendulum"} else True
        )

    @rule(
        position=st.tuples(*[st.floats(-6.0, 6.0)] * 2),
        seconds=st.none() | st.sampled_from((0, -1, 2**31 - 1, -(2**31), 12345)),
    )
    def stray(self, position: tuple[float, float], seconds: int | None) -> None:
        """A message with another state, and perhaps a stamp of another time."""
        message = self.message(stray=True)
        message.position = list(position)
        if seconds is not None:
            message.header.stamp.sec = seconds
        self.give(INPUTS[self.kind][0], message)

    @rule(value=IMPOSSIBLE | st.floats(-100.0, 100.0))
    def estimate(self, value: float) -> None:
        """A friction estimate of any size, for the controller only."""
        if self.kind is ControllerNode:
            self.give("friction_estimate", Float64(data=value), not abs(value) <= 100.0)

    @rule(data=st.data(), new=st.binary(max_size=40))
    def other_bytes(self, data: st.DataObject, new: bytes) -> None:
        """A message that is cut and continued by other bytes."""
        topic = data.draw(st.sampled_from(INPUTS[self.kind]))
        whole = serialize_message(Float64() if "friction" in topic else self.message(stray=True))
        at = data.draw(st.integers(0, len(whole)))
        end = data.draw(st.sampled_from((at, at + len(new), len(whole))))
        self.give(topic, whole[:at] + new + whole[end:])
        if topic == "joint_states":  # an estimate of an impossible state would be refused
            self.samples(1)

    @rule(data=st.data())
    def change(self, data: st.DataObject) -> None:
        """One to three values; they may contradict each other."""
        chosen = data.draw(st.lists(st.sampled_from(self.known), min_size=1, max_size=3))
        self.set({each.name: data.draw(valid_value(each), each.name) for each in chosen})

    @rule(data=st.data())
    def bad_change(self, data: st.DataObject) -> None:
        """One good and one bad value, or a name that there is not."""
        good, bad = (data.draw(st.sampled_from(self.known)) for _ in range(2))
        given = {good.name: data.draw(valid_value(good))}
        if bad.kind is float:
            self.set(given | {bad.name: data.draw(bad_value(bad))}, refuse=True)
        else:
            self.set(given | {data.draw(st.sampled_from(("sigma9", "", "gain.", "π"))): 1.0}, True)

    @rule()
    def restore(self) -> None:
        """All parameters return to their defaults."""
        self.set({e.name: e.default for e in self.known if e.kind is not list}, refuse=False)

    def set(self, given: dict[str, Any], refuse: bool | None = None) -> None:
        """Set parameters; what is refused changes nothing."""
        before = repr(values(self.parameters))
        refused = self.node.change(given)
        assert refuse in (None, refused), given
        if refused:
            assert repr(values(self.parameters)) == before
        else:
            self.twin.change(given)


@pytest.mark.parametrize("kind", INPUTS)
def test_no_message_or_parameter_harms_a_node(ros: None, kind: Any) -> None:
    """Bad input is refused and leaves no trace; good input is not refused."""
    run(lambda: Nodes(kind))
