"""The recommended setting follows from what the settings say of the rig."""

from itertools import product
from math import inf
from pathlib import Path

import numpy as np
import pytest

from furuta.lanes.batch import outcomes
from furuta.outcomes import outcome
from furuta.settings.settings import Settings, load_settings, loop, require_agreement
from furuta_model.parameters import ParameterError
from furuta_sim.simulation.closed_loop import Loop

LATE = "drive.delay=10", "drive.lag=0.015"
ON_TIME = {"drive.delay": 0, "drive.lag": 0.0}
RECOMMENDED = "compensation=recommended"
ENCODER_COUNT = Loop().plant.sensors.encoder_count


def worst_swing(chosen: Settings) -> float:
    """Largest swing of the arm [rad] where friction and delay are wrong by up to half."""
    swings = []
    for level, delay in product((0.5, 1.0, 1.5), (5, 10, 15)):
        true = f"plant.friction.alpha0={0.21 * level}", f"plant.friction.alpha1={0.022 * level}"
        late = f"drive.delay={delay}", f"drive.lag={0.0015 * delay}"
        rig = load_settings([], [*true, *late, "friction.law=stiction", "plant.seed=5"], chosen)
        swings.append(outcome(loop(rig), 30.0).phi_peak_to_peak_rad)
    return max(swings)


def test_it_tells_all_nodes_of_the_drive() -> None:
    """Nothing else changes; without lateness it is the compensation alone."""
    chosen = load_settings([], [RECOMMENDED, *LATE])
    told = {"drive.delay": 10, "drive.lag": 0.015}
    assert chosen["estimator"] == chosen["controller"] == told
    assert chosen["friction_observer"] == {"compensation": "combined"} | told
    on_time = load_settings([], [RECOMMENDED])
    assert loop(on_time) == loop(load_settings([], ["compensation=combined"]))


@pytest.mark.parametrize("told", [LATE, ()])
def test_within_a_count_where_friction_and_delay_are_wrong_by_half(told: tuple[str, ...]) -> None:
    """Also where the late drive is not known at all."""
    assert worst_swing(load_settings([], [*told, RECOMMENDED])) < ENCODER_COUNT


def swings(law: str, levels: tuple[float, ...], name: str) -> np.ndarray:
    """Swings of the arm [rad] with late drives (25) and levels of the friction ``name``."""
    drives = product(range(0, 21, 5), (0.0, 0.01, 0.02, 0.03, 0.04))
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


def test_it_follows_from_the_rig_wherever_it_stands() -> None:
    assert load_settings([], [RECOMMENDED, *LATE]) == load_settings([], [*LATE, RECOMMENDED])


@pytest.mark.parametrize(
    "chosen",
    [
        "friction_observer.drive.lag=0.002",
        "estimator.drive.delay=3.0",
        "friction_observer.bandwidth=30.0",
        "friction_observer.level_rate=2.0",
        "controller.strength=0.3",
    ],
)
def test_what_is_chosen_beside_it_holds(chosen: str) -> None:
    """Before it and after it; on a late drive, which would be told."""
    name, value = chosen.split("=")
    node, _, parameter = name.partition(".")
    for given in ([*LATE, chosen, RECOMMENDED], [RECOMMENDED, chosen, *LATE]):
        assert load_settings([], given)[node][parameter] == float(value)


def test_a_parameter_file_holds_but_its_defaults_do_not(tmp_path: Path) -> None:
    """A file that lists every parameter leaves the choice to the recommended setting."""
    file = tmp_path / "friction_observer.yaml"
    file.write_text(
        "friction_observer: {ros__parameters: {bandwidth: 30.0, drive.delay: 0, drive.lag: 0.0}}"
    )
    found = load_settings([file], [*LATE, RECOMMENDED])["friction_observer"]
    assert found["bandwidth"] == 30.0
    assert (found["drive.delay"], found["drive.lag"]) == (10, 0.015)


def test_the_last_choice_of_a_compensation_counts() -> None:
    assert load_settings([], [RECOMMENDED, "compensation=coulomb"]) == load_settings(
        [], ["compensation=coulomb"]
    )


def test_an_option_and_an_assignment_must_agree() -> None:
    """Neither is dropped."""
    options = {"--seed": "plant.seed=3", "--law": "plant.friction.law=coulomb"}
    require_agreement(["seed=3", "friction.law=coulomb"], options)
    with pytest.raises(ParameterError, match="--seed sets"):
        require_agreement(["seed=4"], options)


def test_friction_and_plant_stay_as_they_are() -> None:
    chosen = load_settings([], ["friction_observer.alpha0=0.3", RECOMMENDED])
    assert chosen["friction_observer"] == {"alpha0": 0.3, "compensation": "combined"} | ON_TIME
    assert chosen["plant"] == load_settings([], [])["plant"]


def test_no_friction_is_accepted() -> None:
    """There is nothing to compensate then, and nothing moves."""
    none = "alpha0=0.0", "alpha1=0.0"
    run = outcome(loop(load_settings([], [*none, "sensors.ideal=true", RECOMMENDED])), 30.0)
    assert run.phi_peak_to_peak_rad < 1e-3
    assert run.command_rms_v < 1e-3
