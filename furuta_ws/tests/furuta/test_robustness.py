"""Robustness over uncertain rigs: probabilities, quantiles, Sobol indices, tuning."""

from __future__ import annotations

import numpy as np
import pytest

from furuta.studies.robustness.robust_tuning import RobustTuning, tune_robustly
from furuta.studies.robustness.robustness import RigStudy, residuals, robustness, sobol
from furuta.studies.robustness.uncertain_rigs import UncertainRigs, relative_ranges
from furuta_friction.compensation import ObserverParameters
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.uncertainty import Uncertainty
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError
from furuta_sim.simulation.closed_loop import Loop, outcome

LUGRE = Loop(observer=ObserverParameters(compensation="lugre"))
RIGS = UncertainRigs(LUGRE, {"alpha0": (0.15, 0.3), "beta": (0.013, 0.016)})
# What a rig file states: a level and a stiffness that go together.
STATED = Uncertainty(("alpha0", "sigma0"), np.array([[0.02**2, 0.004], [0.004, 0.3**2]]))


def test_rig_k_is_the_same_in_a_study_of_any_size() -> None:
    """And its parameters are within their ranges; all others are nominal."""
    many = list(RIGS.loops(1500, seed=4))
    assert many[:10] == list(RIGS.loops(10, seed=4))
    assert many[:10] != list(RIGS.loops(10, seed=5))
    levels = np.array([each.plant.friction.parameters.alpha0 for each in many])
    assert 0.15 <= levels.min() < 0.151
    assert 0.299 < levels.max() <= 0.3
    assert all(each.observer == LUGRE.observer for each in many)
    assert {each.plant.friction.parameters.sigma0 for each in many} == {Friction().sigma0}
    assert len({each.plant.seed for each in many}) == 1500


def test_rigs_are_as_uncertain_as_a_rig_file_says() -> None:
    """About the plant's own values, and correlated; a range replaces what the file says."""
    plant = LUGRE.plant._replace(
        friction=LUGRE.plant.friction._replace(parameters=Friction(alpha0=0.4))
    )
    rigs = UncertainRigs(LUGRE._replace(plant=plant), {}, Rig(), STATED)
    drawn = [each.plant.friction.parameters for each in rigs.loops(2000, seed=1)]
    levels = np.array([each.alpha0 for each in drawn])
    stiffness = np.log([each.sigma0 / Friction().sigma0 for each in drawn])
    assert levels.mean() == pytest.approx(0.4, abs=0.002)
    assert np.cov(levels, stiffness) == pytest.approx(STATED.covariance, rel=0.15)
    study = RigStudy(rigs, 3, 1, 5.0)
    assert [each["alpha0"] for each in study.values()] == levels[:3].tolist()
    within = list(rigs._replace(ranges={"alpha0": (0.1, 0.11)}).loops(500, seed=1))
    assert all(0.1 <= each.plant.friction.parameters.alpha0 <= 0.11 for each in within)


def test_what_is_done_is_not_run_again() -> None:
    """The rigs that remain are those of the whole study."""
    whole = dict(RigStudy(RIGS, 5, 2, 5.0).remaining_loops(()))
    assert list(whole.values()) == list(RIGS.loops(5, seed=2))
    rest = dict(RigStudy(RIGS, 5, 2, 5.0).remaining_loops({0, 3}))
    assert rest == {number: whole[number] for number in (1, 2, 4)}


def test_sobol_indices_need_independent_values() -> None:
    """Those of a rig's covariance are not."""
    with pytest.raises(ParameterError, match="those of the rig correlate"):
        sobol(UncertainRigs(LUGRE, {}, Rig(), STATED), 4, 0, 5.0, lambda: None)


def test_residuals_are_those_of_single_runs() -> None:
    """In the order of the rigs; a fall is infinite."""
    found = list(residuals(RIGS.loops(3, seed=1), 5.0))
    assert found == [outcome(each, 5.0).phi_peak_to_peak_rad for each in RIGS.loops(3, seed=1)]
    falling = LUGRE._replace(
        plant=LUGRE.plant._replace(initial=LUGRE.plant.initial._replace(theta=1.5))
    )
    assert list(residuals([falling], 5.0)) == [np.inf]


def test_probabilities_and_quantile() -> None:
    """Against the tables of Clopper and Pearson: 3 of 100 is 0.62 % to 8.52 %."""
    found = np.concatenate([np.linspace(0.01, 0.097, 97), [np.inf] * 3])
    result = robustness(found, 0.0501)
    assert result.falls == 3
    assert result.fell.low == pytest.approx(0.0062, abs=1e-4)
    assert result.fell.high == pytest.approx(0.0852, abs=1e-4)
    assert result.within_bound.value == pytest.approx(np.mean(found <= 0.0501))
    assert result.p95_rad == np.sort(found)[94]
    assert result.p95_low_rad < result.p95_rad < result.p95_high_rad
    assert result.worst_rad == pytest.approx(0.097)


def test_ranges_are_relative_and_checked() -> None:
    """A parameter that is nominally zero stays; one beyond its declared range is rejected."""
    ranges = relative_ranges(LUGRE.plant, 0.3, 0.0)
    assert ranges["alpha0"] == pytest.approx((0.147, 0.273))
    assert "viscous" not in ranges
    assert "beta" not in ranges
    with pytest.raises(ParameterError, match="alpha0 must be 0 to 100, given -1 to 1"):
        UncertainRigs(LUGRE, {"alpha0": (-1.0, 1.0)}).check()


def test_sobol_indices_find_what_matters() -> None:
    """With Coulomb friction far from its compensation, the level decides, not the stiffness."""
    rigs = UncertainRigs(LUGRE, {"alpha0": (0.1, 0.4), "sigma0": (79.0, 81.0)})
    calls: list[None] = []
    level, stiffness = sobol(rigs, 16, 0, 6.0, lambda: calls.append(None))
    assert len(calls) == 16 * 4
    assert level.parameter == "alpha0"
    assert level.total > 0.7
    assert stiffness.total < 0.3


def test_robust_tuning_lowers_the_quantile_on_its_rigs() -> None:
    """From a level that is far too high; the verdict is on rigs that it was not tuned on."""
    start = LUGRE.observer._replace(friction=Friction(alpha0=0.3), guard_time=0.0)
    rigs = UncertainRigs(LUGRE._replace(observer=start), {"alpha0": (0.19, 0.23)})
    reported: list[float] = []
    tuning = RobustTuning(rigs, ("alpha0",), 20, 6, 6.0, 0)
    result = tune_robustly(tuning, 20, lambda _, found: reported.append(found))
    assert len(reported) == result.trials <= 7
    assert result.after == min(reported) < result.before == reported[0]
    assert result.observer.friction.alpha0 < 0.3
    assert result.fresh_after < result.fresh_before


def test_robust_tuning_starts_from_the_best_compensation() -> None:
    """Levels that are unknown by a half: adaptation beats any fixed level."""
    rigs = UncertainRigs(LUGRE, {"alpha0": (0.1, 0.3)})
    tuning = RobustTuning(rigs, ("sigma1",), 20, 6, 6.0, 0, rivals=("lugre", "adaptive"))
    result = tune_robustly(tuning, 20, lambda *_: None)
    assert result.observer.compensation == "adaptive"
    assert result.after < 0.7 * result.before


def test_rigs_that_fall_have_no_quantile() -> None:
    """With a coupling that the feedback was not designed for no compensation keeps them up."""
    rigs = UncertainRigs(LUGRE, {"gamma": (0.001, 0.002)})
    result = tune_robustly(RobustTuning(rigs, ("alpha0",), 20, 4, 6.0, 0), 20, lambda *_: None)
    assert result.before == result.fresh_after == np.inf
