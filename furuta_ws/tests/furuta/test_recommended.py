"""The recommended setting follows from what the settings say of the rig."""

from itertools import product
from math import inf
from pathlib import Path

import pytest

from furuta.lanes.batch import outcomes
from furuta.outcomes import outcome
from furuta.settings.settings import Settings, load_settings, loop, require_agreement, rig_settings
from furuta_hw.rigs.known_rigs import find_rig
from furuta_model.parameters import ParameterError
from furuta_sim.simulation.closed_loop import Loop

LATE = "drive.delay=10", "drive.lag=0.015"
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


def excess(delay: int, lag: float, level: float) -> float:
    """Swing [rad] beyond the best of four strengths, where the file tells drive and friction."""
    told = [
        *(f"drive.delay={delay}", f"drive.lag={lag}", "friction.law=coulomb"),
        *(f"alpha0={0.21 * level}", f"alpha1={0.022 * level}", RECOMMENDED),
    ]
    strengths = [[], *([f"strength={k}"] for k in (0.1, 0.3, 0.5, 1.0))]
    loops = [loop(load_settings([], [*told, *strength])) for strength in strengths]
    swings = [inf if run.fell else run.phi_peak_to_peak_rad for run in outcomes(loops, 40.0)]
    return swings[0] - min(swings[1:]) if min(swings[1:]) < inf else 0.0


@pytest.mark.parametrize(("delay", "lag"), [(0, 0.04), (12, 0.02), (15, 0.02), (20, 0.03)])
@pytest.mark.parametrize("level", [0.1, 1.0, 3.0])
def test_hardly_worse_than_any_strength_where_all_is_told(
    delay: int, lag: float, level: float
) -> None:
    """Within a count of the best, also where the pendulum falls in some cases."""
    assert excess(delay, lag, level) <= ENCODER_COUNT


@pytest.mark.long
def test_hardly_worse_than_any_strength_over_all_late_drives() -> None:
    drives = product(range(0, 21, 5), (0.0, 0.01, 0.02, 0.03, 0.04), (0.0, 0.1, 1.0, 3.0))
    worse = {each: beyond for each in drives if (beyond := excess(*each)) > ENCODER_COUNT}
    assert not worse


def test_it_follows_from_the_rig_wherever_it_stands() -> None:
    assert load_settings([], [RECOMMENDED, *LATE]) == load_settings([], [*LATE, RECOMMENDED])


@pytest.mark.parametrize(
    "chosen",
    [
        "strength=0.3",
        "strength=1.0",
        "super_twisting=3.0",
        "vibration_limit=0.2",
        "super_twisting_bandwidth=50.0",
        "omega1=9.0",
        "friction_process_noise=0.5",
    ],
)
def test_what_is_chosen_beside_it_holds(chosen: str) -> None:
    """Before it and after it; on a late drive, which gets other values."""
    name, value = chosen.split("=")
    for given in ([*LATE, chosen, RECOMMENDED], [RECOMMENDED, chosen, *LATE]):
        found = load_settings([], given)
        assert (found["controller"] | found["estimator"])[name] == float(value)


def test_poles_are_not_mixed_with_chosen_ones() -> None:
    """A qube behind a late drive gets other poles, unless a user has chosen one of them."""
    base = rig_settings(find_rig("qube_servo_2"))
    names = ("zeta1", "omega2", "zeta2")
    free = load_settings([], [*LATE, RECOMMENDED], base)["controller"]
    held = load_settings([], [*LATE, "omega1=6.0", RECOMMENDED], base)["controller"]
    assert [free[name] for name in names] != [base["controller"][name] for name in names]
    assert [held[name] for name in names] == [base["controller"][name] for name in names]


def test_a_parameter_file_holds_but_its_defaults_do_not(tmp_path: Path) -> None:
    """A file that lists every parameter leaves the choice to the recommended setting."""
    file = tmp_path / "controller.yaml"
    file.write_text("controller: {ros__parameters: {strength: 1.0, super_twisting: 4.0}}")
    found = load_settings([file], [*LATE, RECOMMENDED])["controller"]
    assert found["super_twisting"] == 4.0
    assert found["strength"] < 1.0


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
