"""The recommended setting follows from what the settings say of the rig."""

from itertools import product

import pytest

from furuta.outcomes import outcome
from furuta.settings.settings import Settings, load_settings, loop

LATE = "drive.delay=10", "drive.lag=0.015"
RECOMMENDED, STRENGTH = "compensation=recommended", "strength=0.3"


def worst_swing(chosen: Settings) -> float:
    """Largest swing of the arm [rad] where friction and delay are wrong by up to half."""
    swings = []
    for level, delay in product((0.5, 1.0, 1.5), (5, 10, 15)):
        true = f"plant.friction.alpha0={0.21 * level}", f"plant.friction.alpha1={0.022 * level}"
        late = f"drive.delay={delay}", f"drive.lag={0.0015 * delay}"
        rig = load_settings([], [*true, *late, "friction.law=stiction", "plant.seed=5"], chosen)
        swings.append(outcome(loop(rig), 30.0).phi_peak_to_peak_rad)
    return max(swings)


def test_it_is_the_standard_setting_on_the_papers_rig() -> None:
    chosen = load_settings([], [RECOMMENDED])["controller"]
    assert chosen["strength"] == 1.0
    assert chosen["super_twisting"] == pytest.approx(43.0 * 0.232)
    assert chosen["super_twisting_bandwidth"] == 80.0


def test_a_late_drive_gets_less() -> None:
    """It then swings less in the worst case than the standard setting does."""
    chosen = load_settings([], [*LATE, RECOMMENDED])
    assert 0.02 < chosen["controller"]["strength"] < 0.8
    assert worst_swing(chosen) < 0.8 * worst_swing(load_settings([], [RECOMMENDED]))


def test_it_follows_from_what_comes_before_and_after_it() -> None:
    """Only what comes after it takes the place of what it sets."""
    assert load_settings([], [RECOMMENDED, *LATE]) == load_settings([], [*LATE, RECOMMENDED])
    before, after = (
        load_settings([], given)["controller"]
        for given in ((STRENGTH, RECOMMENDED), (RECOMMENDED, STRENGTH))
    )
    assert before["strength"] == 1.0
    assert after["strength"] == 0.3
    assert before | {"strength": 0.3} == after


def test_a_level_is_not_changed_by_it() -> None:
    """Friction and pendulum stay what the settings say."""
    chosen = load_settings([], ["friction_observer.alpha0=0.3", RECOMMENDED])
    assert chosen["friction_observer"]["alpha0"] == 0.3
    assert chosen["controller"]["super_twisting"] == pytest.approx(43.0 * 0.322)
    assert chosen["plant"] == load_settings([], [])["plant"]


def test_no_friction_is_accepted() -> None:
    """There is nothing to compensate then."""
    none = "friction_observer.alpha0=0.0", "friction_observer.alpha1=0.0"
    assert load_settings([], [*none, RECOMMENDED])["controller"]["super_twisting"] < 1e-6
