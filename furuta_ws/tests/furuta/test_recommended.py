"""The recommended compensation: late drives, wrong and unknown friction, how it is told."""

from itertools import product
from math import inf

import numpy as np
import pytest

from furuta.lanes.batch import outcomes
from furuta.outcomes import outcome
from furuta.settings.settings import Settings, load_settings, loop, require_agreement
from furuta_model.parameters import ParameterError
from furuta_sim.simulation.closed_loop import Loop

LATE = "drive.delay=10", "drive.lag=0.015"
RECOMMENDED = "compensation=recommended"
ENCODER_COUNT = Loop().plant.sensors.encoder_count


def worst_swing(chosen: Settings, milliseconds: tuple[int, ...]) -> float:
    """Largest swing of the arm [rad] with delays and lags and levels of sticking friction."""
    swings = []
    for level, late in product((0.5, 1.0, 1.5), milliseconds):
        true = {
            **{"friction.alpha0": 0.21 * level, "friction.alpha1": 0.022 * level},
            **{"drive.delay": late, "drive.lag": 0.0015 * late, "friction.law": "stiction"},
        }
        given = [f"plant.{name}={value}" for name, value in true.items()]
        rig = load_settings([], [*given, "plant.seed=5"], chosen)
        swings.append(outcome(loop(rig), 30.0).phi_peak_to_peak_rad)
    return max(swings)


def test_whoever_observes_is_told_of_the_drive() -> None:
    """By one name, as all know the friction by one."""
    chosen = load_settings([], [RECOMMENDED, *LATE])
    told = {"drive.delay": 10, "drive.lag": 0.015}
    assert chosen["plant"] == chosen["estimator"] == told
    assert chosen["friction_observer"] == {"compensation": "recommended"} | told


def test_within_a_count_where_friction_and_delay_are_wrong_by_half() -> None:
    assert worst_swing(load_settings([], [*LATE, RECOMMENDED]), (5, 10, 15)) < ENCODER_COUNT


def test_within_a_count_where_a_late_drive_is_not_known() -> None:
    """A delay and a lag of 5 and 7.5 ms."""
    assert worst_swing(load_settings([], [RECOMMENDED]), (0, 5)) < ENCODER_COUNT


def swings(law: str, levels: tuple[float, ...], name: str) -> np.ndarray:
    """Swings of the arm [rad] with late drives (16) and levels of the friction ``name``."""
    drives = product(range(0, 16, 5), (0.0, 0.01, 0.02, 0.03))
    loops = [
        loop(
            load_settings(
                [],
                [
                    *(f"drive.delay={delay}", f"drive.lag={lag}", f"friction.law={law}"),
                    *(f"{name}alpha0={0.21 * level}", f"{name}alpha1={0.022 * level}"),
                    RECOMMENDED,
                ],
            )
        )
        for delay, lag in drives
        for level in levels
    ]
    runs = outcomes(loops, 40.0)
    return np.array([inf if run.fell else run.phi_peak_to_peak_rad for run in runs])


def test_a_late_drive_costs_nothing_where_the_friction_is_known() -> None:
    """A fifth of a count for any level."""
    assert max(swings("lugre", (0.0, 0.1, 1.0, 3.0), "")) < 0.2 * ENCODER_COUNT


def test_sticking_that_the_model_does_not_have_behind_a_late_drive() -> None:
    """Within a count up to the level that is known, hardly above it at three times that level."""
    assert max(swings("coulomb", (0.0, 0.1, 1.0), "plant.friction.")) < ENCODER_COUNT
    assert max(swings("coulomb", (3.0,), "plant.friction.")) < 1.2 * ENCODER_COUNT


def test_an_option_and_an_assignment_must_agree() -> None:
    """Neither is dropped."""
    options = {"--seed": "plant.seed=3", "--law": "plant.friction.law=coulomb"}
    require_agreement(["seed=3", "friction.law=coulomb"], options)
    with pytest.raises(ParameterError, match="--seed sets"):
        require_agreement(["seed=4"], options)


def test_no_friction_is_accepted() -> None:
    """There is nothing to compensate then, and the compensation is none."""
    none = "alpha0=0.0", "alpha1=0.0", "sensors.ideal=true"
    without = outcome(loop(load_settings([], none)), 30.0)
    run = outcome(loop(load_settings([], [*none, RECOMMENDED])), 30.0)
    assert run.phi_peak_to_peak_rad == pytest.approx(without.phi_peak_to_peak_rad, rel=1e-6)
    assert run.command_step_v == pytest.approx(without.command_step_v, rel=1e-6)
