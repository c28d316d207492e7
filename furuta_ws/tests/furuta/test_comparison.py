"""Rigs, candidates and runs of a comparison."""

from dataclasses import replace

import numpy as np
import pytest

from furuta.outcomes import outcome
from furuta.settings.nodes import NODES
from furuta.settings.settings import default_settings, load_settings, loop
from furuta.studies.comparison.candidates import STANDARD, parse_candidates
from furuta.studies.comparison.comparison import Comparison
from furuta.studies.comparison.rigs import (
    DISTURBANCES,
    FRICTION_ERROR,
    MODEL_ERROR,
    TRAINING,
    RandomRigs,
    named_rigs,
    nominal_values,
)
from furuta_hw.rigs.uncertainty import Uncertainty
from furuta_model.friction.laws import LAWS
from furuta_model.parameters import ParameterError, declared

SETTINGS = default_settings()
NOMINAL = nominal_values(SETTINGS)
PLANT = {each.name for each in declared(NODES["plant"].parameters)}
ALL = DISTURBANCES
# What a rig file states: a level and a stiffness that go together.
STATED = Uncertainty(("alpha0", "sigma0"), np.array([[0.02**2, 0.004], [0.004, 0.3**2]]))
LEVEL = "friction.alpha0"
RIGS = list(RandomRigs(SETTINGS, 2))


def test_named_rigs_change_the_plant() -> None:
    """Each by parameters that exist, to values that differ from the nominal ones."""
    rigs = named_rigs(SETTINGS)
    assert len(rigs) == len({rig.name for rig in rigs}) == 54
    for rig in rigs:
        assert len(rig.name) <= 28
        assert rig.values.keys() <= PLANT, rig.name
        changed = [name for name, value in rig.values.items() if value != NOMINAL[name]]
        assert bool(changed) == (rig.name != "nominal"), rig.name


def test_named_rigs_that_a_compensation_may_not_expect() -> None:
    """Their drive is late by whole samples, and friction that sticks has no bristle."""
    settings = load_settings([], ["sample_time=0.002", "plant.friction.viscous=0.1"])
    rigs = {rig.name: rig.plant(settings) for rig in named_rigs(settings)}
    late = rigs["delay 10 lag 15, x 0.3"]
    assert (late.drive.late.delay * late.sample_time, late.drive.late.lag) == (0.01, 0.015)
    assert late.friction.parameters.alpha0 == pytest.approx(0.3 * NOMINAL[LEVEL])
    assert late.friction.parameters.viscous == pytest.approx(0.03)
    without = rigs["backlash 5 mrad, no friction"]
    assert max(without.friction.parameters[2:4]) == without.friction.parameters.viscous == 0.0
    assert (without.coupling.backlash, without.drive.late.delay) == (0.005, 0)


def test_random_rig_is_the_same_in_any_number() -> None:
    """Another seed has others, as have those to train on."""
    rigs = RandomRigs(SETTINGS, 12, 7, ALL, uncertainty=STATED)
    many = list(rigs)
    assert len({rig.plant(SETTINGS) for rig in many}) == len(rigs) == 12
    assert list(replace(rigs, size=4)) == many[:4]
    for others in (replace(rigs, seed=8), replace(rigs, purpose=TRAINING)):
        assert all(rig not in many for rig in others)


def test_disturbances_leave_the_other_choices_as_they_are() -> None:
    """A further disturbance sets its own parameters and no other choice."""
    (plain,), (every,) = (list(RandomRigs(SETTINGS, 1, 1, names)) for names in ((), ALL))
    assert every.values.items() >= plain.values.items()
    for name in ALL:
        (one,) = RandomRigs(SETTINGS, 1, 1, (name,))
        assert one.values.items() <= every.values.items(), name
        assert one.values.keys() > plain.values.keys(), name


def test_random_rigs_are_in_their_ranges() -> None:
    """Every law occurs, every error reaches most of its range, and every name exists."""
    rigs = [rig.values for rig in RandomRigs(SETTINGS, 300, 5, ALL)]
    assert {rig["friction.law"] for rig in rigs} == set(LAWS)
    assert all(rig.keys() <= PLANT for rig in rigs)
    for name, error in ((LEVEL, FRICTION_ERROR), ("model.delta", MODEL_ERROR)):
        ratios = np.array([rig[name] for rig in rigs]) / NOMINAL[name]
        assert 1 - error <= ratios.min() < 1 - 0.9 * error
        assert 1 + 0.9 * error < ratios.max() <= 1 + error
    assert max(rig["drive.delay"] for rig in rigs) == 5


def test_rigs_are_as_uncertain_as_a_rig_file_says() -> None:
    """About the settings' values, correlated, and beyond a block of points."""
    settings = load_settings([], ["plant.friction.alpha0=0.4"])
    rigs = RandomRigs(settings, 2000, 1, uncertainty=STATED)
    drawn = [rig.plant(settings).friction.parameters for rig in rigs]
    levels = np.array([friction.alpha0 for friction in drawn])
    stiffness = np.log([friction.sigma0 / NOMINAL["friction.sigma0"] for friction in drawn])
    assert levels.mean() == pytest.approx(0.4, abs=0.002)
    assert np.cov(levels, stiffness) == pytest.approx(STATED.covariance, rel=0.15)


def test_rows_are_those_of_single_runs() -> None:
    """Pushes are in the rows; only the plant differs from the candidate's loop."""
    candidates = parse_candidates(["none", "coulomb"], SETTINGS)
    comparison = Comparison(SETTINGS, RIGS, candidates, 5.0, (3.0,))
    rows = list(comparison.rows())
    assert len(rows) == comparison.size == 8
    assert [row["push_v"] for row in rows[:3]] == [0.0, 3.0, 0.0]
    assert rows[6]["candidate"] == "coulomb"
    plant = RIGS[1].plant(SETTINGS)
    alone = outcome(loop(candidates[1].applied_to(SETTINGS))._replace(plant=plant), 5.0)
    assert rows[6].items() >= vars(alone).items()
    table = comparison.table()
    sizes = [row["phi_peak_to_peak_rad"] for row in rows]
    assert table.residual.T.ravel().tolist() == sizes[::2]
    assert table.survived.shape == (2, 2, 1)


@pytest.mark.parametrize("names", [["coulomb"], ["coulomb", "none"]])
def test_reference_is_without_any_compensation(names: list[str]) -> None:
    """It makes no row unless it is a candidate, and has none of what the settings add."""
    settings = load_settings([], ["compensation=recommended"])
    texts = ["off=compensation=none", "coulomb=strength=0.0"]
    comparison = Comparison(settings, RIGS, parse_candidates(names, settings), 5.0)
    assert [row["candidate"] for row in comparison.rows()] == 2 * names
    table = comparison.table()
    alone = Comparison(settings, RIGS, parse_candidates(texts, settings), 5.0)
    assert len(list(alone.rows())) == 4
    off, weak = alone.table().residual
    assert table.uncompensated.tolist() == off.tolist() == weak.tolist()
    assert max(table.residual[0] / off) < 0.5


def test_impossible_rigs_are_left_out() -> None:
    """With their reason; if there are no others, that is an error."""
    impossible = {"model.gamma": 0.1}
    good, bad = named_rigs(SETTINGS)[0], named_rigs(SETTINGS)[1]._replace(values=impossible)
    candidates = parse_candidates(["none"], SETTINGS)
    comparison = Comparison(SETTINGS, [bad, good], candidates, 5.0)
    assert len(list(comparison.rows())) == 1
    assert comparison.table().rigs == ["nominal"]
    assert comparison.impossible.keys() == {"levels x 0.7"}
    with pytest.raises(ParameterError, match="no rig is possible: alpha"):
        list(Comparison(SETTINGS, [bad], candidates, 5.0).rows())


def test_candidates_are_parsed() -> None:
    """Standard ones by name, others by settings that leave the plant alone; lists have commas."""
    every = parse_candidates(STANDARD, SETTINGS)
    assert [candidate.name for candidate in every] == list(STANDARD)
    text = "stiff=compensation=lugre,sigma0=1000,gain=[1, 2, 3, 4]"
    (stiff,) = parse_candidates([text], SETTINGS)
    made = loop(stiff.applied_to(SETTINGS))
    assert made.observer.friction.sigma0 == 1000.0
    assert made.controller.gain == (1.0, 2.0, 3.0, 4.0)
    assert made.plant == loop(SETTINGS).plant
