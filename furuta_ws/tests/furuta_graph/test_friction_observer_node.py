"""The node ``friction_observer``: one estimate per state, compensation switched by service."""

from testbench import Bench, joint_state

from furuta_friction.friction_observer_node import FrictionObserverNode
from furuta_graph.parameter_client import ParameterClient
from furuta_ros.topics import FRICTION_ESTIMATE, JOINT_STATES


def test_compensation_is_switched_while_running(bench: Bench) -> None:
    """None, then Coulomb with level alpha0 and the sign of the speed, then LuGre."""
    node = bench.add(FrictionObserverNode())
    estimates = bench.collect(FRICTION_ESTIMATE)
    states = bench.publisher(JOINT_STATES)
    client = ParameterClient(bench.probe, bench.executor)
    stamp = 0

    def answer(speed: float, samples: int = 1) -> float:
        nonlocal stamp
        for _ in range(samples):
            stamp += 1_000_000
            count = len(estimates)
            states.publish(joint_state((0.0, speed, 0.0, 0.0), stamp))
            bench.spin(lambda count=count: len(estimates) == count + 1)
        return estimates[-1].data

    assert answer(1.0) == 0.0
    client.set("friction_observer", compensation="coulomb", alpha0=0.3)
    assert answer(1.0) == 0.3
    assert answer(-1.0) == -0.3
    assert answer(0.0) == 0.0
    client.set("friction_observer", compensation="lugre")
    assert abs(answer(1.0, samples=50) - 0.3) < 1e-4
    assert node.parameters.friction.alpha0 == 0.3


def test_every_state_gets_one_estimate(bench: Bench) -> None:
    """A repeated state is answered with the same estimate."""
    bench.add(FrictionObserverNode())
    estimates = bench.collect(FRICTION_ESTIMATE)
    states = bench.publisher(JOINT_STATES)
    for _ in range(2):
        states.publish(joint_state((0.0, 0.5, 0.0, 0.0), 7))
    bench.spin(lambda: len(estimates) == 2)
    assert estimates[0] == estimates[1]
