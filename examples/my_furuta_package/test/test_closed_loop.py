"""My friction observer, alone and in the closed loop: the nodes in this process, in lock-step."""

from furuta_control.controller_node import ControllerNode
from furuta_control.estimator_node import EstimatorNode
from furuta_ros.testing import IN_LOCKSTEP, Bench, joint_state
from furuta_ros.topics import FRICTION_ESTIMATE, GROUND_TRUTH, JOINT_STATES
from furuta_sim.plant_node import PlantNode
from my_furuta_package.my_observer import MyObserver


def test_the_arm_swings_less_than_without_compensation() -> None:
    """Without compensation it swings by 0.51 rad."""
    with Bench() as bench:
        for node in (PlantNode(IN_LOCKSTEP), EstimatorNode(), MyObserver(), ControllerNode()):
            bench.add(node)
        truth = bench.collect(GROUND_TRUTH)
        bench.run_until(20.0)
        settled = [message.position[0] for message in truth[10_000:]]
        assert len(settled) == 10_000
        assert max(settled) - min(settled) < 0.05


def test_it_answers_a_state() -> None:
    """An arm that turns fast has all the friction."""
    with Bench() as bench:
        bench.add(MyObserver())
        estimates = bench.collect(FRICTION_ESTIMATE)
        states = bench.publisher(JOINT_STATES)
        states.publish(joint_state((0.0, 1.0, 0.0, 0.0), stamp=0))
        bench.spin(lambda: len(estimates) == 1)
        assert abs(estimates[0].data - 0.21) < 1e-6
