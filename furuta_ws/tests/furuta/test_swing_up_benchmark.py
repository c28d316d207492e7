"""Benchmark of swing-up: the loop with a disturbed drive, the criteria, and the scores."""

from __future__ import annotations

from collections import Counter
from math import pi, tanh

import numpy as np
import pytest

from furuta.studies.swing_up.benchmark import RIGS, uptime
from furuta.studies.swing_up.disturbed_drive import DisturbedDrive, DisturbedRun, run_disturbed
from furuta.studies.swing_up.performance import performance
from furuta.studies.swing_up.rig_loop import swing_up_settings
from furuta.studies.swing_up.robustness import CRITERIA, cases, robustness, upright_at_end
from furuta_sim.settings.rigs import find_rig
from furuta_sim.settings.settings import load_settings, loop
from furuta_sim.simulation.closed_loop import Loop, simulate

# Its sample time is that of the competition.
RIG = "odrive_furuta"


def rig_loop(name: str = RIG) -> Loop:
    """The loop for swing-up on a rig."""
    return loop(load_settings([], [], swing_up_settings(find_rig(name))))


def still(state: tuple[float, float, float, float], samples: int = 5000) -> DisturbedRun:
    """A run that stays in one state, at 0 V."""
    return DisturbedRun(0.002, np.tile(state, (samples, 1)), np.zeros(samples))


def test_an_undisturbed_drive_is_the_simulation() -> None:
    """They agree to the last bit; with a disturbance or a knock-down they differ."""
    nominal = rig_loop()
    expected = simulate(nominal, 0.6)
    run = run_disturbed(nominal, DisturbedDrive(), 0.6)
    np.testing.assert_array_equal(run.state, expected.state)
    np.testing.assert_array_equal(run.command, expected.command)
    for changed in (
        DisturbedDrive(response=0.5),
        DisturbedDrive(noise=0.5),
        DisturbedDrive(knock_down_period=0.5),
    ):
        assert np.any(run_disturbed(nominal, changed, 0.6).state != expected.state)


@pytest.mark.parametrize("name", RIGS)
def test_cases_are_those_of_the_competition(name: str) -> None:
    """21 levels of each disturbance, noise ten times, 50 runs with six pushes, each possible."""
    nominal = rig_loop(name)
    chosen = cases(nominal, 1)
    assert Counter(each.criterion for each in chosen) == {
        "model": 8 * 21,
        "speed_noise": 210,
        "torque_noise": 210,
        "torque_response": 21,
        "delay": 21,
        "pushes": 50,
    }
    assert all(each.loop.controller == nominal.controller for each in chosen)
    for each in chosen:
        each.loop.plant.check()
        assert each.loop.plant.model.determinant > 0.0
    pushes = [each.loop.plant.pushes for each in chosen if each.criterion == "pushes"]
    assert {each.number for each in pushes} == {6}
    for each in pushes:
        assert 0.5 < min(each.times) < max(each.times) < 9.0
        limit = 5.0 / 6.0 * nominal.controller.voltage_limit
        assert np.count_nonzero(each.arm) == np.count_nonzero(each.pendulum) == 3
        assert np.all(np.abs(each.arm) <= limit)


def test_scores() -> None:
    """A level of noise counts if more than half of its runs succeed; the score is the mean."""
    chosen = cases(rig_loop(), 1)
    assert robustness(chosen, [True] * len(chosen)).score == 1.0
    seen: Counter[int] = Counter()
    successes = []
    for each in chosen:
        seen[each.level] += each.criterion == "torque_noise"
        failed = each.criterion == "torque_noise" and each.level < 10 and seen[each.level] <= 5
        successes.append(not failed)
    found = robustness(chosen, successes)
    assert found.torque_noise == pytest.approx(11 / 21)
    assert found.score == pytest.approx((len(CRITERIA) - 1 + 11 / 21) / len(CRITERIA))


@pytest.mark.parametrize(
    ("state", "success"),
    [
        ((0.3, 0.9, 2.0 * pi - 0.3, -0.9), True),
        ((0.4, 0.0, 0.0, 0.0), False),
        ((0.0, 1.1, 0.0, 0.0), False),
        ((0.0, 0.0, 0.4, 0.0), False),
        ((0.0, 0.0, pi, 0.0), False),
        ((0.0, 0.0, 0.0, -1.1), False),
    ],
)
def test_a_run_succeeds_upright_at_its_end(
    state: tuple[float, float, float, float], success: bool
) -> None:
    """Every angle, modulo a turn, is within 0.35 rad and every speed within 1 rad/s."""
    assert upright_at_end(still(state), 0.0) == success


def test_performance_by_hand() -> None:
    """Upright from the start: the score lost is that of the torque alone; hanging scores 0."""
    nominal = rig_loop()
    volts = nominal.controller.voltage_limit
    upright = still((0.0, 0.0, 0.0, 0.0))
    upright.command[:] = 0.1 * volts
    found = performance(upright, nominal)
    assert found.swing_up_time_s == found.energy == found.velocity_cost_s == 0.0
    assert found.largest_torque == pytest.approx(0.1)
    assert found.integrated_torque_s == pytest.approx(1.0)
    assert found.torque_cost_s == pytest.approx(0.1)
    assert found.score == pytest.approx(1.0 - tanh(pi * 0.1 / (20.0 / 36.0)) / 5.0)
    assert performance(still((0.0, 0.0, pi, 0.0)), nominal).score == 0.0


def test_uptime_counts_knock_downs() -> None:
    """Down for a second at 20 s, and from 50 s on: two knock-downs, one swing-up, 49 s."""
    run = still((0.0, 0.0, 0.0, 0.0), 30_000)
    run.state[10_000:10_500, 2] = run.state[25_000:, 2] = pi
    found = uptime(run)
    assert (found.knock_downs, found.swing_ups) == (2, 1)
    assert found.uptime_s == pytest.approx(49.0)
