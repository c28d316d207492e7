"""The node ``controller``: one command per state, with or without a friction estimate."""

from typing import Any

import numpy as np
import pytest
from counting import count_handled, count_published
from rclpy.parameter import Parameter
from std_msgs.msg import Bool, Float64

from furuta_bringup.graph.parameter_client import ParameterClient
from furuta_bringup.graph.services import ServiceError
from furuta_control.control import POLE_PLACEMENT
from furuta_control.controller_node import ControllerNode
from furuta_control.modes import mode
from furuta_model.linear import DesiredPoles, place_poles
from furuta_model.pendulum import FurutaPendulum
from furuta_ros import node
from furuta_ros.node import LATCHED
from furuta_ros.testing import Bench, joint_state
from furuta_ros.topics import ARMED, COMMAND, FRICTION_ESTIMATE, JOINT_STATES, Topic

X = (0.1, -0.2, 0.03, 0.04)
FEEDBACK = -float(place_poles(FurutaPendulum(), DesiredPoles()) @ np.array(X))
MS = 1_000_000


class Loop:
    """A controller with publishers for both inputs."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.node = bench.add(ControllerNode())
        self.commands = bench.collect(COMMAND)
        self._handled = count_handled(self.node)
        self._published = count_published(self.node._publisher)
        self._states = bench.publisher(JOINT_STATES)
        self._estimates = bench.publisher(FRICTION_ESTIMATE)
        self._expected = 0

    def state(self, milliseconds: int, x: tuple[float, float, float, float] = X) -> None:
        """Send a state and wait until the node has handled it."""
        self._send(self._states, JOINT_STATES, joint_state(x, milliseconds * MS))

    def estimate(self, value: float) -> None:
        """Send a friction estimate and wait until the node has handled it."""
        self._send(self._estimates, FRICTION_ESTIMATE, Float64(data=value))

    def _send(self, publisher: Any, topic: Topic, message: Any) -> None:
        wanted = self._handled[topic.name] + 1
        publisher.publish(message)
        self.bench.spin(lambda: self._handled[topic.name] == wanted)

    def expect(self, *values: float) -> None:
        """The node has published exactly these commands since the last call."""
        published = self._published["messages"]
        self.bench.spin(lambda: len(self.commands) == published)
        assert [c.data for c in self.commands[self._expected :]] == pytest.approx(list(values))
        self._expected = published


@pytest.fixture
def loop(bench: Bench) -> Loop:
    return Loop(bench)


@pytest.fixture
def in_real_time(loop: Loop, monkeypatch: pytest.MonkeyPatch) -> None:
    """No message is too old on a busy computer, as if time were simulated, but it is not."""
    monkeypatch.setattr(node, "_OLDEST", 10**12)
    loop.node.time_is_simulated = lambda: False


def test_in_lockstep_every_state_waits_for_its_estimate(loop: Loop) -> None:
    """However many have had none."""
    for milliseconds in (1, 2, 3):
        loop.state(milliseconds)
    loop.expect()
    loop.estimate(0.1)
    loop.expect(FEEDBACK + 0.1)


def test_nothing_is_integrated_until_the_rig_is_armed(loop: Loop) -> None:
    """Integral action does not move while the torque does not act; once armed it does."""
    client = ParameterClient(loop.bench.probe, loop.bench.executor)
    client.set("controller", integral_time=0.05)
    rig = loop.bench.probe.create_publisher(ARMED.message, ARMED.name, LATCHED)
    for armed, correction in ((False, 0.02), (True, 0.5)):
        rig.publish(Bool(data=armed))
        loop.bench.spin(lambda armed=armed: loop.node._is_applied == armed)
        for milliseconds in range(300):
            loop.state(1 + milliseconds + 300 * armed)
            loop.estimate(0.0)
        loop.bench.spin(lambda armed=armed: len(loop.commands) == 300 + 300 * armed)
        added = abs(loop.commands[-1].data - FEEDBACK)
        assert (added < correction) != armed


def test_late_estimate_is_not_taken_for_the_next(loop: Loop, in_real_time: None) -> None:
    """State 3 is answered at once with the last estimate; state 4 waits again."""
    loop.state(1)
    loop.estimate(0.1)
    loop.state(2)
    loop.state(3)
    loop.expect(FEEDBACK + 0.1, FEEDBACK + 0.1)
    loop.estimate(0.2)
    loop.estimate(0.3)
    loop.expect()
    loop.state(4)
    loop.expect()
    loop.estimate(0.4)
    loop.expect(FEEDBACK + 0.4)
    assert loop.node.missed_estimates == 1


def test_without_observer_it_controls_without_compensation(loop: Loop, in_real_time: None) -> None:
    """From the second state on each is answered at once with F̂ = 0, until an observer starts."""
    for k in range(1, 31):
        loop.state(k)
    loop.expect(*[FEEDBACK] * 29)
    loop.estimate(0.2)
    loop.state(31)
    loop.estimate(0.4)
    loop.expect(FEEDBACK + 0.4)


def test_old_estimate_becomes_zero(loop: Loop, in_real_time: None) -> None:
    """An estimate older than ``friction_timeout`` (10 ms) is not added."""
    loop.state(1)
    loop.estimate(0.1)
    loop.state(5)
    loop.state(6)
    loop.state(30)
    loop.expect(FEEDBACK + 0.1, FEEDBACK + 0.1, FEEDBACK)


def test_a_restart_is_kept_until_a_state_is_answered(loop: Loop, in_real_time: None) -> None:
    """The first state after a gap has no estimate; the next one still forgets the fall."""
    loop.state(1, (0.0, 0.0, 2.0, 0.0))
    loop.estimate(0.0)
    loop.state(2)
    loop.estimate(0.0)
    loop.expect(0.0, 0.0)
    loop.state(1000)
    loop.state(1001)
    loop.expect(FEEDBACK)


def test_a_reset_brings_swing_up_back_without_observer(loop: Loop, in_real_time: None) -> None:
    """An arm beyond its travel ends the swing-up until the plant is reset."""
    loop.node.set_parameters([Parameter("mode", value="swing_up")])
    for k in range(1, 40):
        loop.state(k, (7.0, 0.0, 3.0, 0.0))
    assert loop.node._active_mode == mode.OFF
    for k in range(1000, 1040):
        loop.state(k, (0.0, 0.0, 3.0, 0.0))
    assert loop.node._active_mode == mode.SWINGING


def test_gain_and_poles_by_service(loop: Loop) -> None:
    """A new gain applies at the next sample; a bad one is rejected and changes nothing."""
    client = ParameterClient(loop.bench.probe, loop.bench.executor)
    client.set("controller", gain=[1.0, 2.0, 3.0, 4.0])
    loop.state(1)
    loop.estimate(0.0)
    loop.expect(-(0.1 - 0.4 + 0.09 + 0.16))
    with pytest.raises(ServiceError, match="four numbers"):
        client.set("controller", gain=[1.0, 2.0])
    with pytest.raises(ServiceError, match=r"gain: Wrong parameter type, .*DOUBLE_ARRAY"):
        client.set("controller", gain="abc")
    assert loop.node.parameters.gain == (1.0, 2.0, 3.0, 4.0)
    client.set("controller", gain=[])
    assert loop.node.parameters.gain == POLE_PLACEMENT
    assert list(client.get("controller", ["gain"])["gain"]) == [0.0]
    client.set("controller", enabled=False)
    loop.state(2)
    loop.estimate(0.2)
    loop.expect(0.0)


def test_an_answered_state_that_is_repeated_gets_the_same_command(loop: Loop) -> None:
    """Without a new step, so not with the gain that has been set since."""
    loop.state(1)
    loop.estimate(0.2)
    loop.node.set_parameters([Parameter("gain", value=[1.0, 2.0, 3.0, 4.0])])
    loop.state(1)
    loop.estimate(0.2)
    loop.expect(FEEDBACK + 0.2, FEEDBACK + 0.2)
