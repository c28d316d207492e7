"""The friction observer of a robot's joint: by its name, from any message, beside other joints."""

from array import array
from math import nan
from typing import Any

import pytest
from counting import count_handled
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState

from furuta_friction.friction_observer_node import FrictionObserverNode
from furuta_friction.joint_observer import JointMemory, design_joint, joint_step
from furuta_friction.learned_friction import LARGEST_LEVEL
from furuta_model.accepted_parts import accept_parts
from furuta_model.block import block, new_memory
from furuta_ros.node import BEST_EFFORT
from furuta_ros.testing import Bench, joint_state
from furuta_ros.topics import FRICTION_ESTIMATE, JOINT_STATES, REFERENCE

PERIOD = 2_000_000
GIVEN = {
    "joint": "elbow_joint",
    "sample_time": 0.002,
    "compensation": "coulomb",
    "alpha0": 2.0,
    "axis.inertia": 0.2,
    "axis.friction_process_noise": 3.0,
}


def state(stamp: int, **joints: tuple[float, ...]) -> JointState:
    """A message with position, velocity and effort of joints."""
    message = JointState(name=list(joints))
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, 1_000_000_000)
    columns = zip(*joints.values(), strict=True)
    message.position, message.velocity, message.effort = (array("d", each) for each in columns)
    return message


@pytest.fixture(name="node")
def node_on_bench(bench: Bench) -> Any:
    given = [Parameter(name, value=value) for name, value in GIVEN.items()]
    node = bench.add(FrictionObserverNode(given))
    bench.collect(FRICTION_ESTIMATE)
    return node


@pytest.fixture
def states(bench: Bench, node: Any) -> Any:
    """A publisher of states that the node knows, as the probe knows the node."""
    publisher = bench.publisher(JOINT_STATES)
    bench.wait_for_publisher(FRICTION_ESTIMATE)
    return publisher


def answers(bench: Bench, states: Any, stamp: int, **joints: tuple[float, ...]) -> list[float]:
    """Publish a state; returns all answers once there is another one."""
    received = bench.received[FRICTION_ESTIMATE.name]
    before = len(received)
    states.publish(state(stamp, **joints))
    bench.spin(lambda: len(received) > before)
    return [each.data for each in received]


def test_each_state_of_the_joint_is_answered(bench: Bench, node: Any, states: Any) -> None:
    """In any order of joints, as the core answers; a repeated state gets the same answer."""
    memory, design = new_memory(JointMemory), block(design_joint(node.parameters))
    expected = []
    for k in range(1, 8):
        elbow, stamp = (0.01 * k * k, 0.5, 3.0), k * PERIOD
        position, speed, effort = elbow
        x = (position, speed, effort, nan)
        expected.append(joint_step(memory, x, design, min(k - 1, 1)))
        others = {"gripper": (0.0, 0.0, 0.0), "wrist": (1.0, 2.0, 3.0)}
        joints = {**others, "elbow_joint": elbow} if k % 2 else {"elbow_joint": elbow, **others}
        assert answers(bench, states, stamp, **joints) == expected
    assert expected[-1] == 2.0
    assert answers(bench, states, stamp, **joints)[-1] == expected[-1]


def test_other_publishers_are_no_matter(bench: Bench, node: Any, states: Any) -> None:
    """A gripper publishes on the same topic with best effort; its messages are not refused."""
    gripper = bench.probe.create_publisher(JointState, JOINT_STATES.name, BEST_EFFORT)
    bench.spin(lambda: gripper.get_subscription_count() > 0)
    handled = count_handled(node)
    gripper.publish(state(PERIOD, finger=(0.0, 0.0, 0.0)))
    bench.spin(lambda: handled[JOINT_STATES.name] == 1)
    assert len(answers(bench, states, PERIOD, elbow_joint=(0.0, 0.1, 0.0))) == 1
    assert node.refused == 0
    assert node.second_publishers([]) == ""


def test_a_reference_counts_while_it_is_new(bench: Bench, node: Any, states: Any) -> None:
    """The joint rests, the reference moves: F̂ has its direction for 0.1 s."""
    reference = bench.publisher(REFERENCE)
    handled = count_handled(node)
    reference.publish(state(0, elbow_joint=(0.0, -1.0, 0.0)))
    bench.spin(lambda: handled[REFERENCE.name] == 1)
    for k in range(1, 61):
        found = answers(bench, states, k * PERIOD, elbow_joint=(0.0, 0.0, 0.0))
    assert found[:50] == [-2.0] * 50
    assert found[51:] == [0.0] * 9


def test_what_cannot_be_used_is_refused(bench: Bench, node: Any, states: Any, capfd: Any) -> None:
    """No position, no number, no velocity of a reference: one line each, and the node goes on."""
    reference = bench.publisher(REFERENCE)
    states.publish(JointState(name=["elbow_joint"]))
    states.publish(state(PERIOD, elbow_joint=(1e9, 0.0, 0.0)))
    reference.publish(JointState(name=["elbow_joint"]))
    bench.spin(lambda: node.refused == 3)
    assert len(answers(bench, states, PERIOD, elbow_joint=(0.1, 0.0, 0.0))) == 1
    warned = capfd.readouterr().err
    assert "no position of joint elbow_joint" in warned
    assert "no velocity of joint elbow_joint" in warned


def test_a_missing_effort_is_named(bench: Bench, node: Any, states: Any, capfd: Any) -> None:
    """What needs the observed friction says so while there is none."""
    (result,) = node.set_parameters([Parameter("compensation", value="recommended")])
    assert result.successful
    for effort, is_named in ((1.0, False), (nan, True)):
        answers(bench, states, PERIOD + is_named * PERIOD, elbow_joint=(0.0, 0.0, effort))
        capfd.readouterr()
        node._check()
        assert ("needs effort in joint_states" in capfd.readouterr().err) is is_named


def test_a_wrong_joint_is_named(bench: Bench, node: Any, states: Any, capfd: Any) -> None:
    """Messages come, and none has the joint: the warning and the status say which one has."""
    handled = count_handled(node)
    for joint, is_named in (("elbow_jiont", True), ("elbow_joint", False)):
        states.publish(state(PERIOD, **{joint: (0.0, 0.0, 0.0)}))
        bench.spin(lambda: handled.pop(JOINT_STATES.name, 0) == 1)
        node._check()
        expected = "no message on joint_states has the joint elbow_joint; one has ['elbow_jiont']"
        assert (expected in capfd.readouterr().err) is (node.problem() == expected) is is_named


def test_a_wrong_compensator_is_named(bench: Bench, capfd: Any, no_parts: None) -> None:
    """A part of one's own that gives no possible F̂ is blamed, not the state; nothing is sent."""
    accept_parts(["own_parts:impossible"])
    node = bench.add(
        FrictionObserverNode([Parameter("compensation", value="own_parts:impossible")])
    )
    publisher = bench.publisher(JOINT_STATES)
    for stamp, given in enumerate((nan, 1e9)):
        publisher.publish(joint_state((0.1 * stamp, 0.0, 0.0, 0.0), stamp))
        bench.spin(lambda stamp=stamp: node.refused == stamp + 1)
        node._warned_at.clear()
        assert f"compensation own_parts:impossible gives {given:g} for it" in capfd.readouterr().err


def test_the_limits_of_recommended_are_named(bench: Bench) -> None:
    """Without a level it only observes; at its largest level the friction is larger."""
    given = {"compensation": "recommended", "alpha0": 0.0, "alpha1": 0.0}
    node = bench.add(FrictionObserverNode([Parameter(n, value=v) for n, v in given.items()]))
    node._check()
    assert "alpha0 and alpha1 are 0" in node.problem()
    node.set_parameters([Parameter("alpha0", value=0.2)])
    node._check()
    assert node.problem() == ""
    node._memory["predictive"]["learned"]["level"] = LARGEST_LEVEL
    node._check()
    assert "its level is at its limit, 4 times" in node.problem()


@pytest.mark.parametrize("joint", ["arm", "elbow_joint"])
def test_what_is_learned_is_in_the_status(bench: Bench, joint: str) -> None:
    """In units of the parameters, with the limits named; nothing before it runs."""
    given = {"compensation": "recommended", "joint": joint, "axis.inertia": 0.3, "sigma0": 1e3}
    given |= {"alpha0": 0.2, "alpha1": 0.05, "sample_time": 0.002}
    node = bench.add(FrictionObserverNode([Parameter(n, value=v) for n, v in given.items()]))
    bench.collect(FRICTION_ESTIMATE)
    assert "learned level" not in node.statistics()
    publisher = bench.publisher(JOINT_STATES)
    bench.wait_for_publisher(FRICTION_ESTIMATE)
    at_rest = {"elbow_joint": (0.0, 0.0, 0.0)}
    message = joint_state((0.0,) * 4, PERIOD) if joint == "arm" else state(PERIOD, **at_rest)
    publisher.publish(message)
    bench.spin(lambda: bench.received[FRICTION_ESTIMATE.name])
    learned = node.statistics()
    assert learned["learned level"] == "0.25"
    inverse_inertia, fastest = (45.0, 4.0) if joint == "arm" else (1.0 / 0.3, 1.5)
    smallest = 0.25 * inverse_inertia / (fastest * 50.0) ** 2
    starts = f"{smallest:.4g} (its smallest)" if smallest > 0.25e-3 else "0.00025"
    assert learned["learned presliding"] == starts


def test_a_wrong_sample_time_is_named(bench: Bench, node: Any, states: Any, capfd: Any) -> None:
    """States that come every 8 ms do not suit a sample time of 2 ms."""
    for k in range(1, 6):
        answers(bench, states, k * 4 * PERIOD, elbow_joint=(0.0, 0.0, 0.0))
        if k == 1:
            node._check()
    capfd.readouterr()
    node._check()
    warned = capfd.readouterr().err
    assert "comes every 0.008 s, but sample_time is 0.002 s" in warned
