"""Messages and parameters that cannot be read: nothing ends."""

from functools import partial
from pathlib import Path

import pytest
from odd_messages import MALFORMED
from rcl_interfaces.msg import Parameter, ParameterEvent, ParameterValue
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rosbags.highlevel import AnyReader
from sensor_msgs.msg import JointState

from furuta.settings.nodes import NODES
from furuta.settings.settings import Settings
from furuta_bringup.graph.composed_graph import SimulatedGraph
from furuta_recordings.recorder_node import RecorderNode
from furuta_ros.testing import Bench


@pytest.mark.parametrize("name", NODES)
def test_a_parameter_of_an_unknown_type_is_refused(bench: Bench, name: str) -> None:
    """With a reason, by both services; those of rclpy itself would end the node."""
    node = bench.add(NODES[name].load_class()([]))
    first = next(iter(node._parameters))
    unknown = [Parameter(name=first, value=ParameterValue(type=77))]
    for kind, suffix in ((SetParameters, ""), (SetParametersAtomically, "_atomically")):
        client = bench.probe.create_client(kind, f"{name}/set_parameters{suffix}")
        bench.spin(client.service_is_ready)
        future = client.call_async(kind.Request(parameters=unknown))
        bench.spin(future.done)
        answer = future.result()
        result = answer.result if suffix else answer.results[0]
        assert not result.successful
        assert "77 is not a valid" in result.reason


# Has no known type.
UNKNOWN = Parameter(name="alpha0", value=ParameterValue(type=77))


def test_malformed_messages_do_not_end_a_recording(
    bench: Bench, settings: Settings, tmp_path: Path
) -> None:
    """The bag keeps them, and what comes after them."""
    settings["plant"] |= {"clock": "lockstep", "run_until": 1.0}
    graph = SimulatedGraph(settings, record=partial(RecorderNode, tmp_path / "bag", stamped=True))
    events = bench.probe.create_publisher(ParameterEvent, "/parameter_events", 10)
    states = bench.probe.create_publisher(JointState, "ground_truth", 10)
    bench.spin(lambda: events.get_subscription_count() > 0 and states.get_subscription_count() > 0)
    for data in MALFORMED:
        events.publish(data)
        states.publish(data)
    events.publish(ParameterEvent(node="/plant", changed_parameters=[UNKNOWN]))
    graph.run_until(1.0)
    assert graph.recording_failure is None
    graph.close()
    with AnyReader([tmp_path / "bag"]) as reader:
        counts = {each.topic: each.msgcount for each in reader.connections}
    assert counts["/command"] == 1000
    assert counts["/parameter_events"] > 1
