"""Rigs, candidates, runs and tuning of a comparison."""

from __future__ import annotations

import numpy as np
import pytest

from furuta.studies.comparison.candidates import STANDARD, Candidate, parse_candidates
from furuta.studies.comparison.comparison import Comparison, Rigs
from furuta.studies.comparison.random_rigs import (
    DISTURBANCES,
    FRICTION_ERROR,
    MODEL_ERROR,
    TUNING,
    random_rig,
)
from furuta.studies.comparison.simulated_rigs import named_rigs, nominal_values
from furuta.studies.comparison.tuning import (
    ARM_GUARD,
    TuningBudget,
    fraction,
    tune_candidate,
    value_at,
)
from furuta.studies.sweep import run_locally
from furuta_model.friction.laws import LAWS
from furuta_model.parameters import ParameterError, declared
from furuta_sim.settings.nodes import NODES
from furuta_sim.settings.settings import default_settings, load_settings, loop
from furuta_sim.simulation.closed_loop import Loop, outcome

SETTINGS = default_settings()
NOMINAL = nominal_values(SETTINGS)
PLANT = {each.name for each in declared(NODES["plant"].parameters)}
ALL = tuple(DISTURBANCES)


def random_loops(first: int, count: int) -> dict[str, Loop]:
    """The loop of every random rig with LuGre compensation, by the rig's name."""
    lugre = parse_candidates(["lugre"], SETTINGS, tuned=False)
    rigs = Rigs("random", count, first, 7, ALL)
    comparison = Comparison(SETTINGS, rigs, lugre, 1, (), 30.0)
    loops = (each for _, each in comparison.remaining_loops(set()))
    return {run.rig: each for run, each in zip(comparison.runs(), loops, strict=True)}


def test_named_rigs_change_the_plant() -> None:
    """Each by parameters that exist, to values that differ from the nominal ones."""
    rigs = list(named_rigs(SETTINGS))
    assert len(rigs) == len({rig.name for rig in rigs}) == 15
    for rig in rigs:
        assert rig.values.keys() <= PLANT, rig.name
        changed = [name for name, value in rig.values.items() if value != NOMINAL[name]]
        assert bool(changed) == (rig.name != "nominal"), rig.name


def test_factors_apply_to_the_settings() -> None:
    """Of another rig's friction too."""
    settings = load_settings([], ["plant.friction.alpha0=0.5"])
    (rig,) = (each for each in named_rigs(settings) if each.name == "levels x 0.7")
    assert rig.values["friction.alpha0"] == pytest.approx(0.35)
    assert rig.plant(settings, 0, 0.0, 0.0).friction.parameters.alpha0 == pytest.approx(0.35)


def test_random_rig_is_the_same_alone_and_in_a_batch() -> None:
    """To the last bit, with its plant and its run."""
    batch, alone = random_loops(0, 12), random_loops(9, 1)
    assert alone["9"] == batch["9"]
    assert len({each.plant for each in batch.values()}) == 12


def test_disturbances_leave_the_other_choices_as_they_are() -> None:
    """A further disturbance sets its own parameters and no other choice."""
    plain = random_rig(NOMINAL, 3, 1).values
    assert random_rig(NOMINAL, 3, 1, ALL).values.items() >= plain.items()
    for name in ALL:
        one = random_rig(NOMINAL, 3, 1, (name,)).values
        assert one.items() <= random_rig(NOMINAL, 3, 1, ALL).values.items(), name
        assert one.keys() > plain.keys(), name


def test_random_rigs_are_in_their_ranges() -> None:
    """Every law occurs, every error reaches most of its range, and every name exists."""
    rigs = [random_rig(NOMINAL, k, 5, ALL).values for k in range(300)]
    assert {rig["friction.law"] for rig in rigs} == set(LAWS)
    assert all(rig.keys() <= PLANT for rig in rigs)
    for name, error in (("friction.alpha0", FRICTION_ERROR), ("model.delta", MODEL_ERROR)):
        ratios = np.array([rig[name] for rig in rigs]) / NOMINAL[name]
        assert 1 - error <= ratios.min() < 1 - 0.9 * error
        assert 1 + 0.9 * error < ratios.max() <= 1 + error
    assert max(rig["drive.delay"] for rig in rigs) == 5


def test_tuning_rigs_are_not_judged() -> None:
    """They come from another stream of the same seed."""
    judged = [random_rig(NOMINAL, k, 0).values for k in range(50)]
    assert all(random_rig(NOMINAL, k, 0, (), TUNING).values not in judged for k in range(50))


def test_only_the_plant_differs_between_rigs() -> None:
    """Estimator, friction observer and controller are those of the candidate on every rig."""
    (candidate,) = parse_candidates(["lugre"], SETTINGS, tuned=False)
    expected = loop(candidate.applied_to(SETTINGS))
    for each in random_loops(0, 20).values():
        assert each[1:] == expected[1:]


def test_runs_are_those_of_their_loops() -> None:
    """Seeds and pushes are in the rows, and a row has the outcome of its own loop."""
    candidates = parse_candidates(["none", "coulomb"], SETTINGS, tuned=False)
    comparison = Comparison(SETTINGS, Rigs("random", 2), candidates, 2, (3.0,), 5.0)
    runs = list(comparison.runs())
    assert [(run.seed, run.push_v) for run in runs[:3]] == [(0, 0.0), (1, 0.0), (0, 3.0)]
    found = dict(run_locally(comparison, {0, 5}))
    assert sorted(found) == [1, 2, 3, 4, *range(6, len(runs))]
    loops = dict(comparison.remaining_loops(set()))
    for number in (2, 7):
        given = loops[number]
        assert isinstance(given, Loop)
        expected = outcome(given, 5.0).phi_peak_to_peak_rad
        assert found[number]["phi_peak_to_peak_rad"] == expected
    assert found[1]["phi_peak_to_peak_rad"] != found[2]["phi_peak_to_peak_rad"]


def test_candidates_are_parsed() -> None:
    """Standard ones by name, others by settings that leave the plant alone; lists have commas."""
    every = parse_candidates(STANDARD, SETTINGS, tuned=False)
    assert [each.name for each in every] == list(STANDARD)
    text = "stiff=compensation=lugre,sigma0=1000,gain=[1, 2, 3, 4]"
    (stiff,) = parse_candidates([text], SETTINGS, tuned=False)
    made = loop(stiff.applied_to(SETTINGS))
    assert made.observer.friction.sigma0 == 1000.0
    assert made.controller.gain == (1.0, 2.0, 3.0, 4.0)
    assert made.plant == loop(SETTINGS).plant


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("nothing", "one of none"),
        ("a=", "expected NAME="),
        ("=compensation=lugre", "expected NAME="),
        ("compensation=lugre", "expected PARAMETER=VALUE"),
        ("a=alpho0=1", "no parameter alpho0"),
        ("a=alpha0=-1", "alpha0 must be"),
        ("a=plant.friction.alpha0=1", "only the plant"),
        ("a=encoder_counts=500,estimator.sample_time=0.002", "sample_time"),
        ("a=alpha0=0.1:0.3", "needs --tune-budget"),
    ],
)
def test_bad_candidates_are_rejected(text: str, reason: str) -> None:
    """The error says what is wrong."""
    with pytest.raises(ParameterError, match=reason):
        parse_candidates([text], SETTINGS, tuned=False)


@pytest.mark.parametrize("text", ["a=alpha0=0.3:0.1", "a=alpha0=0:b", "a=compensation=0:1"])
def test_bad_ranges_are_rejected(text: str) -> None:
    """Wrong order, no number, no number's parameter."""
    with pytest.raises(ParameterError, match="LOW"):
        parse_candidates([text], SETTINGS, tuned=True)


def test_a_candidate_is_named_once() -> None:
    """Two candidates of one name could not be told apart in the table."""
    with pytest.raises(ParameterError, match="only once"):
        parse_candidates(["lugre", "lugre=sigma0=1"], SETTINGS, tuned=False)


def test_fraction_and_value_are_inverse() -> None:
    """On logarithmic and linear scales; the ends are reached exactly."""
    for limits in ((0.01, 4.0), (-1.0, 3.0), (0.0, 2.0)):
        assert value_at(0.0, limits) == limits[0]
        assert value_at(1.0, limits) == limits[1]
        for x in (0.1, 0.5, 0.9):
            assert fraction(value_at(x, limits), limits) == pytest.approx(x)


def test_tuning_improves_within_its_budget() -> None:
    """Coulomb compensation with a level that is 40 % too high finds a better one."""
    budget = TuningBudget(12, Rigs("random", 1, purpose=TUNING), 20.0)
    observer = "friction_observer"
    settings = {f"{observer}.compensation": "coulomb", f"{observer}.alpha0": 0.3}
    candidate = Candidate("coulomb", settings, {f"{observer}.alpha0": (0.05, 1.0)})
    tuned = tune_candidate(candidate, SETTINGS, budget)
    assert tuned.evaluations <= 12
    assert tuned.after < 0.7 * tuned.before
    assert 0.1 < tuned.settings[f"{observer}.alpha0"] < 0.28
    assert tuned == tune_candidate(candidate, SETTINGS, budget)


def test_tuning_counts_a_fall_as_the_guard() -> None:
    """And without a range the only evaluation is the start."""
    budget = TuningBudget(12, Rigs("random", 2, purpose=TUNING), 10.0)
    off = Candidate("off", {"controller.mode": "off"}, {})
    tuned = tune_candidate(off, SETTINGS, budget)
    assert (tuned.before, tuned.after, tuned.evaluations) == (ARM_GUARD, ARM_GUARD, 1)
