"""Loops in lanes: the same bits as alone, for every law, compensation and kind of sensors.

``FURUTA_LANES=10000`` tries as many random loops; the suite tries some.
"""

import os

import numpy as np
import pytest
from random_loops import LAWS, METHODS, random_loop

from furuta.lanes.batch import batch
from furuta.lanes.lanes import WIDTH, compile_stages, prepare, run_block
from furuta.outcomes import SETTLED, Outcome, outcome
from furuta_control.control import ControllerParameters
from furuta_control.estimation import EstimatorParameters
from furuta_friction.compensation import COMPENSATIONS, ObserverParameters
from furuta_model.friction.parameters import Friction
from furuta_model.parts.motion import Cogging
from furuta_model.parts.sensor_faults import SensorFaults
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors
from furuta_sim.parameters import InitialState, PlantFriction, PlantParameters
from furuta_sim.simulation.closed_loop import Loop

RANDOM_LOOPS = int(os.environ.get("FURUTA_LANES", "0"))
SECONDS = 2.0
IDEAL = Sensors(ideal=True)


def bits(found: list[Outcome]) -> list[bytes]:
    """Outcomes to the last bit, with NaN."""
    return [np.array(each, dtype=float).tobytes() for each in found]


def in_lanes(loops: list[Loop], seconds: float) -> list[Outcome]:
    """Outcomes of loops of one group, each of which must suit a lane."""
    ready = [prepare(loop, seconds) for loop in loops]
    assert all(each is not None and each.group == ready[0].group for each in ready if ready[0])
    return run_block([each for each in ready if each is not None], SETTLED)


@pytest.mark.parametrize(
    ("ideal", "compensation"), [(True, "none"), (False, "none"), (False, "lugre")]
)
def test_a_block_has_the_bits_of_single_runs(ideal: bool, compensation: str) -> None:
    """Of loops that differ in everything that a block allows, with one that falls among them."""
    sensors = IDEAL if ideal else Sensors()
    loops = [
        Loop(
            PlantParameters(
                FurutaPendulum(alpha=87 / 3074 * (1 + 0.01 * k)),
                PlantFriction(parameters=Friction(sigma0=40.0 * (k + 1), alpha0=0.1 + 0.01 * k)),
                sensors,
                initial=InitialState(theta=1.2 if k == 3 else 0.01 * k),
                seed=k,
            ),
            EstimatorParameters(sensors=sensors),
            ObserverParameters(compensation=compensation),
        )
        for k in range(13)
    ]
    found = in_lanes(loops, SECONDS)
    assert bits(found) == bits([outcome(loop, SECONDS) for loop in loops])
    assert [each.fell for each in found].count(True) >= 1
    assert len(set(bits(found))) == 13


def test_the_lane_and_its_neighbours_do_not_matter() -> None:
    """The same loop in every lane, and alone in a block, has one outcome."""
    loop = Loop(PlantParameters(seed=5), observer=ObserverParameters(compensation="lugre"))
    others = [loop._replace(plant=loop.plant._replace(seed=k)) for k in range(WIDTH - 1)]
    [alone] = bits(in_lanes([loop], SECONDS))
    assert bits(in_lanes([*others, loop], SECONDS))[-1] == alone
    assert bits(in_lanes([loop, *others], SECONDS))[0] == alone


def test_loops_that_do_not_suit_a_lane_run_singly() -> None:
    """Rigs with parts or faults, other modes; a batch of them has the outcomes of single runs."""
    unsuited = [
        Loop(PlantParameters(cogging=Cogging(0.05))),
        Loop(PlantParameters(sensor_faults=SensorFaults(arm_bias=0.01))),
        Loop(PlantParameters(friction=PlantFriction("maxwell_slip"))),
        Loop(controller=ControllerParameters(mode="off")),
        Loop(controller=ControllerParameters(enabled=False)),
    ]
    assert [prepare(loop, SECONDS) for loop in unsuited] == [None] * len(unsuited)
    mixed = [*unsuited, *(Loop(PlantParameters(seed=k)) for k in range(WIDTH))]
    assert bits(list(batch(mixed, SECONDS))) == bits([outcome(each, SECONDS) for each in mixed])


def test_batch_uses_lanes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Loops of one kind run in blocks once their stages are compiled, the first ones singly."""
    blocks: list[int] = []

    def counted(loops: list, settled: float) -> list[Outcome]:  # type: ignore[type-arg]
        blocks.append(len(loops))
        return run_block(loops, settled)

    monkeypatch.setattr("furuta.lanes.batch.run_block", counted)
    loops = [Loop(PlantParameters(seed=k)) for k in range(200)]
    compile_stages(loops[:1])
    assert len(list(batch(loops, SECONDS, workers=1))) == 200
    assert max(blocks) == WIDTH
    assert sum(blocks) > 180


@pytest.mark.skipif(not RANDOM_LOOPS, reason="on demand: FURUTA_LANES=10000")
def test_random_loops_have_the_bits_of_single_runs() -> None:
    """Every law, compensation, estimator and kind of sensors; each in blocks and alone."""
    r = np.random.default_rng(1)
    kinds = [
        (law, compensation, method, ideal)
        for law in LAWS
        for compensation in COMPENSATIONS
        for method in METHODS
        for ideal in (False, True)
    ]
    for kind in kinds:
        ready: dict = {}  # type: ignore[type-arg]
        for _ in range(-(-RANDOM_LOOPS // len(kinds))):
            loop = random_loop(r, *kind)
            prepared = prepare(loop, SECONDS)
            assert prepared is not None
            ready.setdefault(prepared.group, []).append((loop, prepared))
        for members in ready.values():
            for first in range(0, len(members), WIDTH):
                block = members[first : first + WIDTH]
                found = run_block([prepared for _, prepared in block], SETTLED)
                alone = [outcome(loop, SECONDS) for loop, _ in block]
                assert bits(found) == bits(alone), kind
