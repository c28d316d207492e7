"""The soak itself: oracles of physics can fail, slices repeat, and short slices find nothing."""

from math import inf, nan, pi
from pathlib import Path

import numpy as np
import pytest

from furuta_hw.rigs.rig import Rig
from furuta_sim.emulator.emulated_rig import plant_of
from furuta_sim.plant import design_plant, initial_plant, move
from soak import oracles
from soak.__main__ import run_slice
from soak.campaigns import full_disk
from soak.record import Slice

ONES, ZEROS = np.ones(100), np.zeros(100)
TIME = np.arange(100) * 1e6


def moved(volts: float, samples: int) -> np.ndarray:
    """States (n, 4) of the rig's plant under a constant voltage."""
    plant = plant_of(Rig())
    memory, states = initial_plant(plant)[0], []
    for _ in range(samples):
        states.append(memory["x"][:4].copy())
        move(memory, volts, design_plant(plant))
    return np.array(states)


def test_the_oracle_of_energy_can_fail() -> None:
    """A falling pendulum keeps its energy; one that is suddenly faster does not."""
    plant, states = plant_of(Rig()), moved(0.0, 800)
    given = (np.zeros(800), plant.model, plant.friction.parameters)
    assert oracles.energy_growth(states, *given) == ""
    states[-1, 3] *= 1.2
    assert oracles.energy_growth(states, *given)


def test_the_oracle_of_the_emulated_rig_can_fail() -> None:
    """It finds a difference of one bit."""
    plant, states = plant_of(Rig()), moved(1.0, 50)
    given = (np.ones(50), design_plant(plant), plant)
    assert oracles.different_motion(states, *given) == ""
    states[-1, 2] = np.nextafter(states[-1, 2], inf)
    assert oracles.different_motion(states, *given)


def test_the_oracles_of_drive_can_fail() -> None:
    """No voltage while hanging, without arming, or after the watchdog's time."""
    hanging = np.full(100, pi)
    assert oracles.hanging_drive(hanging, ZEROS, 0.001) == ""
    assert oracles.hanging_drive(hanging, ONES, 0.001)
    assert oracles.unarmed_drive(ONES, ONES, 1) == ""
    assert oracles.unarmed_drive(ONES, ZEROS, 1)
    assert oracles.armed_without_request(ONES, 1) == ""
    assert oracles.armed_without_request(ONES, 0)
    assert oracles.late_stop(TIME, ONES * (TIME < 5e7), 1e6, 9e7, 51e6) == ""
    assert oracles.late_stop(TIME, ONES * (TIME < 6e7), 1e6, 9e7, 51e6)


def test_the_oracles_of_strangers_can_fail() -> None:
    """A second publisher's commands, and a second graph."""
    assert oracles.applied(ONES, 9.87, 0.005) == oracles.applied(ONES, 9.87) == ""
    assert oracles.applied(ONES * 9.869, 9.87, 0.005)
    assert oracles.applied(ONES * 9.87, 9.87)
    assert oracles.wrong_second_graph(1, "error: a graph already runs in namespace /", False) == ""
    assert oracles.wrong_second_graph(0, "2000 samples, 2.000 s", False)
    assert oracles.wrong_second_graph(0, "2000 samples, 2.000 s", True) == ""


@pytest.mark.parametrize("value", [nan, inf, -10.1])
def test_the_oracles_of_values_can_fail(value: float) -> None:
    """Outputs, states and friction estimates within their limits."""
    assert oracles.bad_output(-10.0, 10.0) == oracles.beyond_friction_limit(10.0, 10.0) == ""
    assert oracles.bad_output(value, 10.0)
    assert oracles.beyond_friction_limit(value, 10.0)
    assert oracles.out_of_bounds(np.full((1, 4), 10 * value))


def test_the_oracle_of_recordings_can_fail(tmp_path: Path) -> None:
    """A missing bag is correct only if the recording ended; a damaged one never is."""
    assert full_disk.unreadable(tmp_path, complete=False) == ""
    assert full_disk.unreadable(tmp_path, complete=True)
    (tmp_path / "bag.db3").write_bytes(b"no bag")
    assert full_disk.unreadable(tmp_path, complete=False)


@pytest.mark.long
@pytest.mark.parametrize(("campaign", "steps"), [("messages", 4000), ("wire", 3), ("plant", 30)])
def test_a_short_slice_breaks_no_oracle(campaign: str, steps: int) -> None:
    """A second or two of each campaign within this process, with a fixed seed."""
    record = run_slice(Slice(campaign, 0, 1, 0.0, steps))
    assert record.failures == []
    assert record.step == steps
    assert record.checks.total() > 0
