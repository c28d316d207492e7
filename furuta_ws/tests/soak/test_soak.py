"""The soak itself: every oracle can fail, slices repeat, and short slices find nothing."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import inf, nan, pi
from pathlib import Path

import numpy as np
import pytest

from furuta_friction.compensation import ObserverParameters, design_compensator, largest_estimate
from furuta_hw.rigs.rig import Rig
from furuta_model.friction.parameters import Friction
from furuta_model.pendulum import FurutaPendulum
from furuta_sim.emulator.emulated_rig import plant_of
from furuta_sim.plant import design_plant, initial_plant, move
from soak import oracles
from soak.campaigns import full_disk
from soak.oracles import ORACLES
from soak.record import Record, Slice
from soak.report import write_report
from soak.scheduler import LANES, plan, run_slice


def fall(grows: bool) -> tuple[np.ndarray, np.ndarray, FurutaPendulum, Friction]:
    """States of a pendulum that falls and, if its energy ``grows``, is faster than it can be."""
    plant = plant_of(Rig())
    memory, states = initial_plant(plant)[0], []
    for _ in range(800):
        states.append(memory["x"][:4].copy())
        move(memory, 0.0, design_plant(plant))
    states[-1][3] *= 1.2 if grows else 1.0
    return np.array(states), np.zeros(800), plant.model, plant.friction.parameters


def rig_log(wrong: float) -> str:
    """The problem in the log of a rig whose last angle is ``wrong`` by so much."""
    plant = plant_of(Rig())
    memory, states = initial_plant(plant)[0], []
    for _ in range(50):
        states.append(memory["x"][:4].copy())
        move(memory, 1.0, design_plant(plant))
    states[-1][2] += wrong
    return oracles.different_motion(np.array(states), np.ones(50), design_plant(plant), plant)


def series(growth: float) -> list[dict[str, float]]:
    """Resources of a process whose memory grows by so much every second [MB]."""
    return [{"memory": 100 + growth * k, "files": 5, "threads": 3} for k in range(60)]


LIMIT = largest_estimate(0.1, design_compensator(ObserverParameters(compensation="lugre")))
HANGING, UPRIGHT = np.full(100, pi), np.full(100, 0.1)
ONES = np.ones(100)
TIME = np.arange(100) * 1e6
STATES = np.arange(40.0).reshape(10, 4)
WARNING = "controller: two publishers on joint_states"
TRACEBACK = "Traceback (most recent call last):\nValueError: x"

# For each oracle: its result on traces that hold, and on broken ones.
EXAMPLES: dict[str, tuple[list[Callable[[], str]], list[Callable[[], str]]]] = {
    "energy": (
        [lambda: oracles.energy_growth(*fall(False))],
        [lambda: oracles.energy_growth(*fall(True))],
    ),
    "bounds": (
        [lambda: oracles.out_of_bounds(STATES)],
        [partial(oracles.out_of_bounds, STATES * value) for value in (nan, inf, 10.0)],
    ),
    "friction limit": (
        [lambda: oracles.beyond_friction_limit(-LIMIT, LIMIT)],
        [partial(oracles.beyond_friction_limit, v, LIMIT) for v in (1.01 * LIMIT, nan)],
    ),
    "hanging": (
        [
            lambda: oracles.hanging_drive(HANGING, 0 * ONES, 0.001),
            lambda: oracles.hanging_drive(UPRIGHT + 2 * pi, ONES, 0.001),
        ],
        [lambda: oracles.hanging_drive(HANGING, ONES, 0.001)],
    ),
    "unarmed": (
        [
            lambda: oracles.unarmed_drive(ONES, ONES, 1),
            lambda: oracles.unarmed_drive(ONES * (TIME == 0.0), 0 * ONES, 1),
        ],
        [
            lambda: oracles.unarmed_drive(ONES, 0 * ONES, 1),
            lambda: oracles.unarmed_drive(ONES * (TIME == 0.0), 0 * ONES, 0),
        ],
    ),
    "one command": (
        [
            lambda: oracles.wrong_command_count(5, 5, 5),
            lambda: oracles.wrong_command_count(5, 7, 6),
        ],
        [
            lambda: oracles.wrong_command_count(5, 5, 6),
            lambda: oracles.wrong_command_count(5, 5, 4),
        ],
    ),
    "watchdog": (
        [lambda: oracles.late_stop(TIME, ONES * (TIME < 5e7), 1e6, 9e7, 51e6)],
        [lambda: oracles.late_stop(TIME, ONES * (TIME < 6e7), 1e6, 9e7, 51e6)],
    ),
    "arming": (
        [lambda: oracles.armed_without_request(ONES, 1)],
        [lambda: oracles.armed_without_request(ONES, 0)],
    ),
    "refusal": (
        [
            lambda: oracles.wrong_refusal(True, True, "x"),
            lambda: oracles.wrong_refusal(None, True, "x"),
        ],
        [
            lambda: oracles.wrong_refusal(True, False, "x"),
            lambda: oracles.wrong_refusal(False, True, "x"),
        ],
    ),
    "unchanged": (
        [lambda: oracles.changed_parameters({"a": nan}, {"a": nan})],
        [
            lambda: oracles.changed_parameters({"a": 1.0}, {"a": 2.0}),
            lambda: oracles.changed_parameters({"a": 1.0}, {}),
        ],
    ),
    "output": (
        [lambda: oracles.bad_output(-10.0, 10.0)],
        [partial(oracles.bad_output, value, 10.0) for value in (nan, inf, 10.1)],
    ),
    "survival": (
        [
            lambda: oracles.unexplained_end(None, ""),
            lambda: oracles.unexplained_end(1, "error: no such port"),
        ],
        [
            lambda: oracles.unexplained_end(-11, ""),
            lambda: oracles.unexplained_end(None, TRACEBACK),
        ],
    ),
    "recovery": (
        [lambda: oracles.not_recovered(True, "samples", 1.0)],
        [lambda: oracles.not_recovered(False, "samples", 1.0)],
    ),
    "named": (
        [lambda: oracles.not_named("joint_states", [WARNING])],
        [
            lambda: oracles.not_named("command", [WARNING]),
            lambda: oracles.not_named("command", ["refused a message on command"]),
        ],
    ),
    "graph = simulation": (
        [lambda: oracles.different_run([1, 3], STATES[[1, 3]], STATES)],
        [
            lambda: oracles.different_run([1, 3], np.nextafter(STATES[[1, 3]], inf), STATES),
            lambda: oracles.different_run([11], STATES[:1], STATES),
        ],
    ),
    "twin": (
        [lambda: oracles.different_value([(nan, 0.1)], [(nan, 0.1)])],
        [lambda: oracles.different_value([(0.1,)], []), lambda: oracles.different_value(0.0, -0.0)],
    ),
    "rig = simulation": ([lambda: rig_log(0.0)], [lambda: rig_log(1e-15)]),
    "frames": (
        [lambda: oracles.different_value((1, 2), (1, 2))],
        [lambda: oracles.different_value((1, 2), None)],
    ),
    "flat": (
        [lambda: oracles.growth(series(0.0)), lambda: oracles.growth(series(0.0)[:4])],
        [lambda: oracles.growth(series(1.0))],
    ),
}


def test_every_oracle_has_examples() -> None:
    """A new oracle needs a trace that breaks it; the one of recordings needs files, see below."""
    assert EXAMPLES.keys() == ORACLES.keys() - {"recording"}


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_oracle_can_fail(name: str) -> None:
    """It is silent on traces that hold, and says what is wrong with each of the others."""
    good, broken = EXAMPLES[name]
    assert [problem() for problem in good] == [""] * len(good)
    assert all(problem() for problem in broken)


def test_the_oracle_of_recordings_can_fail(tmp_path: Path) -> None:
    """A missing bag is correct only if the recording ended; a damaged one never is."""
    assert full_disk.unreadable(tmp_path, complete=False) == ""
    assert full_disk.unreadable(tmp_path, complete=True)
    (tmp_path / "bag.mcap").write_bytes(b"no bag")
    assert full_disk.unreadable(tmp_path, complete=False)


@pytest.mark.parametrize(
    ("campaign", "steps"), [("messages", 4000), ("wire", 3), ("plant", 30), ("graph", 3)]
)
def test_a_short_slice_breaks_no_oracle(campaign: str, steps: int) -> None:
    """A second or two of each campaign within this process, with a fixed seed."""
    record = run_slice(Slice(campaign, 0, 1, 0.0, steps))
    assert record.failures == []
    assert record.step == steps
    assert record.checks.total() > 0


def test_a_slice_is_repeated_by_its_seed() -> None:
    """Seed, campaign and number determine the random choices."""
    part = Slice("wire", 3, 7, 1.0)
    first = part.random().integers(2**62)
    assert part.random().integers(2**62) == first
    for other in (part._replace(seed=8), part._replace(number=4), part._replace(campaign="rig")):
        assert other.random().integers(2**62) != first


@pytest.mark.parametrize("seconds", [5.0, 3600.0])
def test_a_soak_of_any_length_has_all_campaigns(seconds: float) -> None:
    """And every lane takes the time given."""
    for lane in LANES:
        parts = list(plan(lane, seconds, 1))
        assert {part.campaign for part in parts} == lane.keys()
        assert sum(part.seconds for part in parts) == pytest.approx(seconds)


def test_a_failure_is_in_the_report(tmp_path: Path) -> None:
    """With the command that repeats it; the exit status is 1."""
    record = Record(Slice("messages", 4, 9, 1.0))
    record.step = 12
    record.tried["command: enormous"] += 3
    record.tried["kill controller"] += 1
    record.check("output", "published nan")
    load = {"cores": 2, "busy_fraction": 0.5, "mean_load": 1.0, "largest_load": 2.0}
    assert write_report(tmp_path, [record.as_json()], load, 60.0, 9) == 1
    text = (tmp_path / "report.md").read_text()
    assert "make soak SLICE=messages:4 SEED=9 STEPS=12`: published nan" in text
    assert "3 messages and 0 frames mutated, 1 kills or pauses" in text
    assert write_report(tmp_path, [], load, 60.0, 9) == 0
