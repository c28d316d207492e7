"""The node ``plant`` in lock-step and in real time."""

from math import nan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from rclpy.parameter import Parameter
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from testbench import Bench

from furuta_ros.topics import COMMAND, GROUND_TRUTH, MEASUREMENT
from furuta_sim import realtime
from furuta_sim.plant import design_plant, initial_plant, move
from furuta_sim.plant_node import PlantNode

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


def test_lockstep_moves_once_per_command(bench: Bench) -> None:
    """Sample k + 1 follows only after the command for k, one period later, as the core computes."""
    node = plant(bench, clock="lockstep")
    measurements, truths = bench.collect(MEASUREMENT), bench.collect(GROUND_TRUTH)
    commands = bench.publisher(COMMAND)
    rig = node.parameters.plant
    memory = initial_plant(rig)
    x = memory["x"][0]
    bench.spin(lambda: len(measurements) == 1)
    bench.settle()
    assert len(measurements) == 1
    for k in range(1, 4):
        commands.publish(Float64(data=0.5 * k))
        bench.spin(lambda k=k: len(truths) == k + 1 == len(measurements))
        torque = move(memory[0], 0.5 * k, design_plant(rig))
        assert measurements[-1].effort[0] == torque == pytest.approx(0.5 * k, abs=20 / 4096)
        assert truths[-1].header.stamp.nanosec == k * 1_000_000
        assert [*truths[-1].position, *truths[-1].velocity] == x[[0, 2, 1, 3]].tolist()


def test_lockstep_rejects_nan_and_keeps_waiting(bench: Bench) -> None:
    """A command that is not finite moves nothing."""
    node = plant(bench, clock="lockstep")
    measurements = bench.collect(MEASUREMENT)
    commands = bench.publisher(COMMAND)
    bench.spin(lambda: len(measurements) == 1)
    commands.publish(Float64(data=nan))
    bench.spin(lambda: node.refused == 1)
    assert node.sample == 0
    commands.publish(Float64(data=0.0))
    bench.spin(lambda: len(measurements) == 2)


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


def test_reset_puts_the_pendulum_back(bench: Bench) -> None:
    """The service holds the initial state until the next command."""
    node = plant(bench)
    commands = bench.publisher(COMMAND)
    commands.publish(Float64(data=0.0))
    bench.spin(lambda: abs(node.x[2]) > 0.5)
    client = bench.probe.create_client(Trigger, "plant/reset")
    assert client.wait_for_service(10.0)
    answer = client.call_async(Trigger.Request())
    bench.spin(answer.done)
    assert answer.result().success
    held = node.sample
    bench.spin(lambda: node.sample > held + 20)
    assert node.x[2] == 0.05
