"""The node ``plant`` in lock-step and in real time."""

import itertools
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from rclpy.parameter import Parameter
from std_msgs.msg import Float64

from furuta_control.control import ControllerParameters
from furuta_model.friction.names import LAWS
from furuta_model.parameters import ParameterError, build
from furuta_ros.testing import Bench
from furuta_ros.topics import COMMAND, GROUND_TRUTH, MEASUREMENT
from furuta_sim import realtime
from furuta_sim.parameters import PlantParameters
from furuta_sim.plant_node import PlantNode
from furuta_sim.simulation.closed_loop import Loop, Simulation

BEGAN, PERIOD = 5_000_000_000, 1_000_000  # [ns]


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """The steady clock of real time, which stands at ``now`` [ns]."""
    clock = SimpleNamespace(now=BEGAN)
    monkeypatch.setattr(realtime, "monotonic_ns", lambda: clock.now)
    return clock


def plant(bench: Bench, **values: Any) -> PlantNode:
    named = {name.replace("__", "."): value for name, value in values.items()}
    return bench.add(PlantNode([Parameter(name, value=value) for name, value in named.items()]))


def test_lockstep_pauses_and_continues(bench: Bench) -> None:
    """``run_until`` stops time; raising it continues from the same sample."""
    node = plant(bench, clock="lockstep", run_until=0.002)
    measurements = bench.collect(MEASUREMENT)
    commands = bench.publisher(COMMAND)
    for k in (1, 2):
        bench.spin(lambda k=k: len(measurements) == k)
        commands.publish(Float64(data=0.0))
    bench.spin(lambda: node.paused)
    bench.settle()
    assert len(measurements) == 2
    node.set_parameters([Parameter("run_until", value=1.0)])
    bench.spin(lambda: len(measurements) == 3)
    assert measurements[-1].header.stamp.nanosec == 2_000_000


def test_a_push_that_is_set_later_begins_at_once(bench: Bench) -> None:
    """Its time counts from the change, in samples of the plant."""
    node = plant(bench, clock="lockstep", friction__alpha0=0.0, friction__alpha1=0.0)
    node.held = False

    def pushed(size: float) -> list[bool]:
        """In which of 8 samples the arm is pushed after the pushes have been set."""
        values = {"times": [0.002], "durations": [0.003], "arm": [size]}
        node.set_parameters_atomically(
            [Parameter(f"pushes.{name}", value=value) for name, value in values.items()]
        )
        speeds = [node.x[1]]
        for _ in range(8):
            node.move(0.0)
            speeds.append(node.x[1])
        return [bool(step > 0.01) for step in np.diff(speeds)]

    for size in (1.0, 2.0, 3.0):
        assert pushed(size) == [False] * 2 + [True] * 3 + [False] * 3


@pytest.mark.parametrize("cogging", [0.0, 0.01])
def test_pushes_that_change_move_the_simulation_as_the_node(bench: Bench, cogging: float) -> None:
    """Their time counts from the change, to the last bit of the state."""
    node = plant(bench, clock="lockstep", cogging__torque=cogging)
    node.held = False
    given = build(PlantParameters, {"cogging.torque": cogging})
    simulation = Simulation(Loop(given, controller=ControllerParameters(mode="off")))
    for _ in range(300):
        node.move(0.0)
    simulation.run(0.3)
    pushes = {"pushes.times": [0.02], "pushes.durations": [0.01], "pushes.arm": [1.0]}
    node.set_parameters_atomically([Parameter(name, value=v) for name, v in pushes.items()])
    changed = build(PlantParameters, {"cogging.torque": cogging, **pushes})
    simulation.loop = simulation.loop._replace(plant=changed)
    before = node.x[1]
    for _ in range(31):
        node.move(0.0)
    simulation.run(0.031)
    assert abs(node.x[1] - before) > 0.1
    assert node.x.tobytes() == simulation.state.tobytes()


@pytest.mark.parametrize("before", LAWS)
def test_another_friction_law_does_not_throw_the_arm(before: str) -> None:
    """Nor another stiffness: friction is never above its largest level, which is 0.232 V."""
    given = {"initial.phi_dot": 2.0, "initial.theta": 0.0}
    first = build(PlantParameters, given | {"friction.law": before})
    for law, stiffness in itertools.product(LAWS, (80.0, 8000.0)):
        simulation = Simulation(Loop(first))
        simulation.run(0.05)
        assert abs(simulation.state[1]) > 0.5
        other = {"friction.law": law, "friction.sigma0": stiffness}
        simulation.loop = Loop(build(PlantParameters, given | other))
        assert np.max(np.abs(simulation.run(0.1).friction)) < 0.3


@pytest.mark.parametrize("name", ["sample_time", "seed"])
def test_a_simulation_keeps_what_is_read_at_its_start(name: str) -> None:
    """As on the graph, another value is rejected and changes nothing."""
    loop = Loop()
    simulation = Simulation(loop)
    other = loop._replace(plant=loop.plant._replace(**{name: 2 * getattr(loop.plant, name) + 1}))
    with pytest.raises(ParameterError, match=rf"plant.{name} is .* for the whole simulation"):
        simulation.loop = other
    assert simulation.loop == loop


def test_realtime_holds_until_the_first_command(bench: Bench) -> None:
    """The rig stays in its initial state until it is controlled, then falls."""
    node = plant(bench, sensors__ideal=True)
    truths = bench.collect(GROUND_TRUTH)
    commands = bench.publisher(COMMAND)
    bench.spin(lambda: len(truths) >= 50)
    assert {t.position[1] for t in truths} == {0.05}
    commands.publish(Float64(data=0.0))
    bench.spin(lambda: truths[-1].position[1] > 0.06)
    assert node.pacing.timing_counts.samples > 0


def test_realtime_keeps_its_grid_over_a_pause(bench: Bench, clock: SimpleNamespace) -> None:
    """A timer that is late during a pause moves no later deadline."""
    node = plant(bench, run_until=0.0)
    clock.now = BEGAN + 700 * PERIOD + 400_000
    node.pacing._tick()
    assert node.sample == 0
    node.set_parameters([Parameter("run_until", value=1.0)])
    for k in range(1, 6):
        clock.now = BEGAN + (700 + k) * PERIOD
        node.pacing._tick()
        assert node.sample == k


def test_realtime_stale_command_becomes_zero(bench: Bench, clock: SimpleNamespace) -> None:
    """A command acts on the arm for ``command_timeout``; then it is 0 V until the next one."""
    node = plant(bench, command_timeout=0.02, friction__alpha0=0.0, friction__alpha1=0.0)
    commands = bench.publisher(COMMAND)
    commands.publish(Float64(data=5.0))
    bench.spin(lambda: not node.held)
    for k in range(1, 41):
        clock.now = BEGAN + k * PERIOD
        node.pacing._tick()
    assert node.pacing.timing_counts.timeouts == 20
    assert abs(node.x[1]) == pytest.approx(5.0 * 45.0 * 0.02, rel=0.2)
    commands.publish(Float64(data=-5.0))
    bench.spin(lambda: node.pacing._command == -5.0)
    before = node.pacing.timing_counts.timeouts  # the timer may have moved one sample more
    clock.now += 2 * PERIOD
    node.pacing._tick()
    assert node.pacing.timing_counts.timeouts == before
    assert node.pacing.timing_counts.on_time == 2
