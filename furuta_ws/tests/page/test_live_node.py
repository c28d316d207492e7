"""What the view receives: throttled copies, or the topics themselves where there are none."""

from collections.abc import Iterator

import numpy as np
import pytest
from rclpy.parameter import Parameter

from furuta.settings.settings import Settings
from furuta_bringup.graph.composed_graph import SimulatedGraph
from furuta_bringup.page.live_node import LiveNode
from furuta_bringup.page.samples import ESTIMATE, FRICTION, PHI, THETA, TIME
from furuta_ros.spinning import spin_until
from furuta_ros.testing import Bench, joint_state
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, GROUND_TRUTH, JOINT_STATES

LOOP = (JOINT_STATES, COMMAND)
# These have a throttled copy each.
COPIED = (*LOOP, FRICTION_ESTIMATE, GROUND_TRUTH)


@pytest.fixture
def view(ros: None) -> Iterator[LiveNode]:
    node = LiveNode(lambda event: None, lambda time, phi, theta: None)
    yield node
    node.destroy_node()


def subscribed(view: LiveNode) -> set[str]:
    return {each.topic_name.strip("/") for each in view.subscriptions}


def test_simulated_graph(view: LiveNode, settings: Settings) -> None:
    """True state and friction, estimate and command, a hundred samples per second.

    No subscription makes a node send every sample.
    """
    settings["plant"] |= {"clock": "lockstep", "run_until": 0.0}
    graph = SimulatedGraph(settings)
    spin_until(graph.executor, lambda: view.has_truth)
    view.choose_topics()
    names = {topic.name for topic in COPIED}
    assert not subscribed(view) & names
    inputs = [t for t in COPIED if t is not JOINT_STATES]
    count = graph.plant.count_subscribers
    spin_until(graph.executor, lambda: all(count(t.throttled.name) for t in inputs))
    throttled = [p for n in graph.nodes for p in n.publishers if p.topic_name.endswith("_throttle")]
    expected = {f"/{each.throttled.name}" for each in inputs}
    matched = [each for each in throttled if each.topic_name in expected]
    spin_until(graph.executor, lambda: all(each.get_subscription_count() for each in matched))
    graph.plant.set_parameters([Parameter("run_until", value=1.0)])
    spin_until(graph.executor, lambda: graph.plant.paused)
    while len(view.samples.last(10.0)) < 100:
        view.collect()
    samples = view.samples.last(10.0)
    assert samples[:, TIME] == pytest.approx(np.arange(100) / 100)
    assert np.isfinite(samples[:, PHI : THETA + 1]).all()
    assert np.isfinite(samples[:, FRICTION]).all()
    graph.close()


def test_node_without_throttled_copies(bench: Bench, view: LiveNode) -> None:
    """A node of another kind publishes the topics only; then the view receives these."""
    states, commands = (bench.probe.create_publisher(t.message, t.name, 10) for t in LOOP)
    bench.spin(lambda: all(view.is_published(each) for each in LOOP))
    view.choose_topics()
    assert {JOINT_STATES.name, COMMAND.name} <= subscribed(view)
    assert GROUND_TRUTH.throttled.name not in subscribed(view)
    bench.spin(lambda: all(p.get_subscription_count() for p in (states, commands)))
    commands.publish(COMMAND.message(data=0.25))
    states.publish(joint_state((0.1, 0.2, 0.3, 0.4), 5 * NANOSECONDS, effort=0.5))

    def received() -> bool:
        view.collect()
        return len(view.samples.last(1.0)) > 0

    bench.spin(received)
    (sample,) = view.samples.last(1.0)
    assert sample[[TIME, PHI, THETA]] == pytest.approx([5.0, 0.1, 0.3])
    assert np.isnan(sample[[FRICTION, ESTIMATE]]).all()
