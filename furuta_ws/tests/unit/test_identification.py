"""Identification on logs whose truth is known: closed loop upright, and a swinging pendulum."""

from __future__ import annotations

import numpy as np
import pytest
from rig_log import Truth, swing

from furuta_analysis.closed_loop import Loop, simulate
from furuta_control.excitation import ExcitationParameters
from furuta_control.parameters import ControllerParameters, EstimatorParameters
from furuta_identification.fit import identify
from furuta_identification.model import Model
from furuta_identification.momentum import momentum_fit, ratios, speed_lag, with_speeds
from furuta_identification.preparation import Options, prepare
from furuta_identification.quality import fit_percent, follow, held_out
from furuta_identification.record import Recording
from furuta_identification.report import node_parameters, standard_errors, summary, undetermined
from furuta_model.lugre import LuGre
from furuta_model.parameters import ParameterError
from furuta_model.sensors import Sensors
from furuta_sim.parameters import Plant
from furuta_sim.rig import NOISE_CHANNELS, drive, measure

PAPER = {"a23": -11.0, "a43": 33.0, "b21": 45.0, "b41": -29.0}


def balanced(
    seconds: float, ideal: bool, seed: int = 0, excitation: ExcitationParameters | None = None
) -> Recording:
    """A closed-loop log of the simulated rig: what its sensors said, what its drive gave."""
    plant = Plant(friction=LuGre(asymmetry=0.1), sensors=Sensors(ideal=ideal), seed=seed)
    estimator = EstimatorParameters(sensors=Sensors(ideal=ideal))
    controller = ControllerParameters(excitation=excitation or ExcitationParameters())
    run = simulate(Loop(plant=plant, estimator=estimator, controller=controller), seconds)
    noise = np.random.default_rng(seed).standard_normal((len(run.command), NOISE_CHANNELS))
    measured = np.empty((len(run.command), 4))
    for row, x, each in zip(measured, run.state, noise, strict=True):
        measure(x, each, plant.sensors, row)
    command = np.array([drive(u, plant.actuator) for u in run.command])
    return Recording("balanced", run.time, measured, run.time, command)


@pytest.mark.parametrize(
    ("ideal", "tolerance", "coulomb"), [(True, 1e-3, 1e-3), (False, 0.03, 0.05)]
)
def test_paper_s_numbers_from_the_closed_loop(
    ideal: bool, tolerance: float, coulomb: float
) -> None:
    """a23, a43, b21, b41 and the Coulomb level, with ideal sensors and with the paper's."""
    found = summary(identify([balanced(10.0 if ideal else 30.0, ideal)], Options()))
    assert {name: found[name] for name in PAPER} == pytest.approx(PAPER, rel=tolerance)
    assert found["coulomb"] == pytest.approx(0.21, rel=coulomb)
    assert found["asymmetry"] == pytest.approx(0.1, rel=coulomb)


def test_excitation_tells_more() -> None:
    """The same time of recording, driven, leaves less error; half at most where most was left."""
    excitation = ExcitationParameters("multisine", amplitude=1.0)
    quiet = identify([balanced(10.0, ideal=False)], Options())
    driven = identify([balanced(10.0, ideal=False, excitation=excitation)], Options())
    before, after, found = standard_errors(quiet), standard_errors(driven), summary(driven)
    for name, truth in PAPER.items():
        assert after[name] < before[name]
        assert found[name] == pytest.approx(truth, rel=0.01)
    assert after["a23"] < before["a23"] / 2.0


@pytest.fixture(scope="module")
def swung() -> tuple[Recording, Model]:
    """A log of a swinging pendulum and its model."""
    log = swing("sine")
    return log, identify([log], Options())


def test_a_swinging_pendulum_with_all_that_is_odd(swung: tuple[Recording, Model]) -> None:
    """Inertias, friction, delay, lag, tilt and zero of a real rig's kind of log."""
    truth, guess = Truth(), swung[1].guess
    for name, relative in (("beta", 0.1), ("gamma", 0.1), ("delta", 0.1), ("viscous", 0.05)):
        assert guess[name] == pytest.approx(getattr(truth, name), rel=relative)
    assert guess.body.alpha == pytest.approx(truth.alpha, rel=0.2)
    assert guess["coulomb"] == pytest.approx(truth.coulomb, rel=0.2)
    assert np.sqrt(guess["delta"] / guess["beta"]) == pytest.approx(
        np.sqrt(0.22 / 0.0025), rel=0.01
    )
    assert guess["lag"] == pytest.approx(truth.lag, abs=5e-4)
    assert (guess["tilt_x"], guess["tilt_y"]) == pytest.approx(truth.tilt, abs=0.015)
    fits = follow(swung[1], swung[1].recordings[0]).fits()
    assert min(fits["arm speed"], fits["pendulum angle"]) > 90.0


def test_standard_errors_hold_the_truth(swung: tuple[Recording, Model]) -> None:
    """The truth lies within four of them, and they are small enough to say something."""
    truth, model = Truth(), swung[1]
    found, errors = summary(model), standard_errors(model)
    for name in ("beta", "gamma", "delta", "viscous"):
        assert abs(found[name] - getattr(truth, name)) < 4.0 * errors[name]
        assert errors[name] < 0.3 * getattr(truth, name)


def test_a_model_predicts_another_record(swung: tuple[Recording, Model]) -> None:
    """Fitted on the sine, run freely along a step whose first command was lost."""
    followed, findings = held_out(swung[1], swing("step"), Options())
    fits = followed.fits(3.0)
    assert fits["arm speed"] > 80.0
    assert fits["pendulum angle"] > 70.0
    assert any("first command is missing" in each for each in findings)


def test_what_the_data_do_not_tell_is_not_told(swung: tuple[Recording, Model]) -> None:
    """A fast swing says nothing of the bristle: reasons instead of numbers."""
    found = summary(swung[1])
    for name in ("alpha1", "stribeck_velocity"):
        assert found["lugre"][name] is None
        assert name in undetermined(swung[1])
    parameters = node_parameters(swung[1])
    assert "stribeck_velocity" not in parameters["friction_observer"]["ros__parameters"]


@pytest.mark.parametrize("turned", [(0.0, 1.0), (np.pi, -1.0), (np.pi, 1.0), (0.0, -1.0)])
def test_orientation_is_found(turned: tuple[float, float]) -> None:
    """Whatever the pendulum's zero and direction, it ends upright and counted as in (1)."""
    log = swing("sine")
    upright = prepare(log, Options())[0]
    other = upright.turned(turned[0], turned[1], 1.0)
    back, findings = prepare(other, Options())
    np.testing.assert_allclose(
        np.sin(back.measured[:, 2]), np.sin(upright.measured[:, 2]), atol=1e-9
    )
    assert any("(found)" in each for each in findings)
    assert np.all(ratios(with_speeds(back, speed_lag(back))) > 0.0)


def test_a_wrong_zero_is_contradicted() -> None:
    """The motion knows better than the user."""
    with pytest.raises(ParameterError, match="as if its zero were hanging"):
        prepare(swing("sine", seconds=3.0), Options(zero="upright"))


def test_regression_on_momenta() -> None:
    """The first step alone: natural frequency within 2 %, lag within 1 ms."""
    log = swing("sine")
    assert speed_lag(log) == pytest.approx(0.008, abs=1e-3)
    ready = prepare(log, Options())[0]
    fit = momentum_fit(with_speeds(ready, speed_lag(ready)))
    assert np.sqrt(fit.delta / fit.beta) == pytest.approx(np.sqrt(0.22 / 0.0025), rel=0.02)
    assert fit.viscous == pytest.approx(0.25, rel=0.1)


def test_dropouts_are_bridged_and_told() -> None:
    """A gap and missing values in the log."""
    log = swing("sine")
    keep = np.abs(log.time - 2.0) > 0.05
    measured = log.measured.copy()
    measured[500:520, 1] = np.nan
    measured[700, 0] = np.nan
    gappy = log._replace(time=log.time[keep], measured=measured[keep])
    ready, findings = prepare(gappy, Options())
    assert np.all(np.isfinite(ready.measured))
    assert any("dropout of 0.1" in each for each in findings)
    assert any("1 of" in each for each in findings)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"command": np.zeros(0), "command_time": np.zeros(0)}, "no command in it"),
        ({"measured": np.full((2000, 4), np.nan)}, "no angle of the arm"),
    ],
)
def test_useless_logs_are_refused(change: dict[str, np.ndarray], reason: str) -> None:
    """What is missing, in one line."""
    with pytest.raises(ParameterError, match=reason):
        identify([swing("sine")._replace(**change)], Options())


def test_fit_percent() -> None:
    """100 for a perfect prediction, 0 for the mean, NaN for what does not move."""
    y = np.sin(np.arange(100.0))
    assert fit_percent(y, y) == 100.0
    assert fit_percent(y, np.full(100, y.mean())) == pytest.approx(0.0)
    assert np.isnan(fit_percent(np.ones(10), np.ones(10)))
