"""Loops in lanes: the same bits as alone, for every law, compensation and kind of sensors.

``FURUTA_LANES=10000`` tries as many random loops; the suite tries some.
"""

import os
from itertools import product

import numpy as np
import pytest
from random_loops import LAWS, METHODS, random_loop

from furuta.lanes.batch import batch
from furuta.lanes.lanes import WIDTH, compile_stages, prepare, run_block
from furuta.outcomes import SETTLED, Outcome, outcome
from furuta_control.control import ControllerParameters
from furuta_friction.compensation import COMPENSATIONS
from furuta_model.parts.motion import Cogging
from furuta_model.parts.sensor_faults import SensorFaults
from furuta_sim.parameters import PlantFriction, PlantParameters
from furuta_sim.simulation.closed_loop import Loop

RANDOM_LOOPS = int(os.environ.get("FURUTA_LANES", "0"))
# Law, compensation, estimator and whether the sensors are ideal.
EVERY = list(product(LAWS, COMPENSATIONS, METHODS, (False, True)))
USUAL = [
    ("lugre", "none", "kalman", True),
    ("lugre", "none", "kalman", False),
    ("lugre", "lugre", "kalman", False),
]
SECONDS = 2.0


def bits(found: list[Outcome]) -> list[bytes]:
    """Outcomes to the last bit, with NaN."""
    return [np.array([*vars(each).values()], dtype=float).tobytes() for each in found]


def random_block(r: np.random.Generator, kind: tuple[str, str, str, bool]) -> list[Loop]:
    """Random loops with one estimator, controller, converters and encoder."""
    first, *others = (random_loop(r, *kind) for _ in range(WIDTH))
    shared = {"sensors": first.plant.sensors, "actuator": first.plant.actuator}
    return [first, *(first._replace(plant=each.plant._replace(**shared)) for each in others)]


@pytest.mark.parametrize("kind", EVERY if RANDOM_LOOPS else USUAL)
def test_random_loops_have_the_bits_of_single_runs(kind: tuple[str, str, str, bool]) -> None:
    """In blocks of loops that differ in everything that a block allows; some fall."""
    r = np.random.default_rng(1)
    for _ in range(-(-RANDOM_LOOPS // (len(EVERY) * WIDTH)) or 1):
        loops = random_block(r, kind)
        ready = [each for each in (prepare(loop, SECONDS) for loop in loops) if each is not None]
        assert len(ready) == WIDTH and len({each.group for each in ready}) == 1
        found = run_block(ready, SETTLED)
        assert bits(found) == bits([outcome(loop, SECONDS) for loop in loops])
        assert len(set(bits(found))) == WIDTH
        assert any(each.fell for each in found)


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
