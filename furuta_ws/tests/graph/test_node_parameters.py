"""Parameters of all nodes, through ROS."""

import pytest
from rclpy.parameter import Parameter

from furuta.settings.nodes import NODES
from furuta_bringup.graph.parameter_client import ParameterClient
from furuta_control.estimator_node import EstimatorNode
from furuta_model.parameters import declared
from furuta_ros.testing import Bench


@pytest.mark.parametrize("name", NODES)
def test_every_parameter_is_described(bench: Bench, name: str) -> None:
    """Each has its meaning, unit and range in its descriptor, and its default as value."""
    bench.add(NODES[name].load_class()())
    client = ParameterClient(bench.probe, bench.executor)
    expected = {parameter.name: parameter for parameter in declared(NODES[name].parameters)}
    assert set(expected) <= set(client.names(name))
    values = client.get(name, list(expected))
    for descriptor in client.describe(name, list(expected)):
        parameter = expected[descriptor.name]
        assert parameter.about.meaning in descriptor.description
        assert parameter.about.unit in descriptor.description
        assert descriptor.read_only == parameter.about.read_only
        assert parameter.checked(values[parameter.name]) == parameter.default


def test_a_rig_without_a_filter_is_refused(bench: Bench) -> None:
    """Where no Kalman filter can be computed, the service says so and nothing changes."""
    node = bench.add(EstimatorNode())
    before = node.parameters
    body = {"alpha": 1e-6, "beta": 1e-9, "gamma": 1e-9, "delta": 1.0}
    changes = [Parameter(f"model.{name}", value=value) for name, value in body.items()]
    result = node.set_parameters_atomically(changes)
    assert not result.successful
    assert "no Kalman filter" in result.reason
    assert node.parameters == before
