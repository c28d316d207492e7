"""Identification on logs whose truth is known: closed loop upright, and a swinging pendulum."""

from __future__ import annotations

import numpy as np
import pytest
from rig_log import Truth, swing

from furuta_analysis.simulation.closed_loop import Loop, simulate
from furuta_control.excitation import ExcitationParameters
from furuta_control.parameters import ControllerParameters, EstimatorParameters
from furuta_identification.fitting.identify import identify
from furuta_identification.fitting.model import Model
from furuta_identification.fitting.report import (
    node_parameters,
    standard_errors,
    summary,
    undetermined,
)
from furuta_identification.preparation.pieces import pieces
from furuta_identification.preparation.preparation import Options, prepare
from furuta_identification.regression.momentum import momentum_fit, ratios
from furuta_identification.regression.speeds import speed_lag, with_speeds
from furuta_identification.uncertainty.quality import fit_percent, follow, held_out
from furuta_model.lugre import LuGre
from furuta_model.parameters import ParameterError
from furuta_model.sensors import Sensors
from furuta_recordings.recording import Recording
from furuta_sim.parameters import PlantParameters
from furuta_sim.plant import NOISE_CHANNELS, drive, measure

PAPER = {"a23": -11.0, "a43": 33.0, "b21": 45.0, "b41": -29.0}


def balanced(
    seconds: float, ideal: bool, seed: int = 0, excitation: ExcitationParameters | None = None
) -> Recording:
    """A closed-loop log of the simulated rig: what its sensors said, what its drive gave."""
    plant = PlantParameters(friction=LuGre(asymmetry=0.1), sensors=Sensors(ideal=ideal), seed=seed)
    estimator = EstimatorParameters(sensors=Sensors(ideal=ideal))
    controller = ControllerParameters(excitation=excitation or ExcitationParameters())
    run = simulate(Loop(plant=plant, estimator=estimator, controller=controller), seconds)
    noise = np.random.default_rng(seed).standard_normal((len(run.command), NOISE_CHANNELS))
    measured = np.empty((len(run.command), 4))
    for row, x, each in zip(measured, run.state, noise, strict=True):
        measure(x, each, plant.sensors, row)
    command = np.array([drive(u, plant.actuator) for u in run.command])
    return Recording("balanced", run.time, measured, run.time, command)


def test_paper_s_numbers_from_ideal_sensors() -> None:
    """a23, a43, b21, b41 and the Coulomb level, as exact as the model."""
    found = summary(identify([balanced(5.0, ideal=True)], Options()))
    assert {name: found[name] for name in PAPER} == pytest.approx(PAPER, rel=1e-3)
    assert found["coulomb"] == pytest.approx(0.21, rel=1e-3)
    assert found["asymmetry"] == pytest.approx(0.1, rel=1e-3)


@pytest.fixture(scope="module")
def quiet() -> Model:
    """What the limit cycle tells with the paper's sensors."""
    return identify([balanced(20.0, ideal=False)], Options())


def test_paper_s_numbers_from_the_closed_loop(quiet: Model) -> None:
    """The same with the paper's sensors; the truth lies within what is stated."""
    found, errors = summary(quiet), standard_errors(quiet)
    assert {name: found[name] for name in PAPER} == pytest.approx(PAPER, rel=0.03)
    assert found["coulomb"] == pytest.approx(0.21, rel=0.05)
    assert found["asymmetry"] == pytest.approx(0.1, rel=0.05)
    for name, truth in PAPER.items():
        assert abs(found[name] - truth) < 4.0 * errors[name]


def test_excitation_tells_more(quiet: Model) -> None:
    """Half the time of recording, driven, leaves less error; half of it where most was left."""
    excitation = ExcitationParameters("multisine", amplitude=1.0)
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
    other = upright.reoriented(turned[0], turned[1], 1.0)
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


def test_another_rig_s_units_signs_and_clock(swung: tuple[Recording, Model]) -> None:
    """Degrees, rpm, a motor the other way round, commands logged 20 ms late: the same model."""
    usual, model = swung
    odd = usual._replace(
        measured=usual.measured * np.array([180 / np.pi, 30 / np.pi, 180 / np.pi, -30 / np.pi]),
        command=-usual.command,
        command_time=usual.command_time + 0.02,
    )
    found = identify([odd], Options())
    for name in ("beta", "gamma", "delta", "viscous", "coulomb"):
        assert found.guess[name] == pytest.approx(model.guess[name], rel=0.05)
    assert summary(found)["setup"]["delay"] == pytest.approx(Truth().delay - 0.02, abs=0.008)
    said = " ".join(found.findings)
    for words in (
        "in deg (found)",
        "arm's speed is in rpm",
        "counted the other way",
        "sign inverted",
    ):
        assert words in said
    fits = held_out(found, odd, Options())[0].fits()
    assert min(fits["arm speed"], fits["pendulum angle"]) > 90.0


def test_a_speed_that_is_none_is_left_out() -> None:
    """A speed that is no slope of its angle, in no unit, does not count."""
    log = swing("sine", seconds=3.0)
    ready, findings = prepare(log._replace(measured=log.measured * [1, 2.0, 1, 1]), Options())
    assert np.all(np.isnan(ready.measured[:, 1]))
    assert any("arm's speed is not the slope of its angle" in each for each in findings)


def test_commands_that_are_no_volts_are_asked_for() -> None:
    """Millivolts are not fitted as volts."""
    log = swing("sine", seconds=3.0)
    odd = log._replace(command=1000.0 * log.command)
    with pytest.raises(ParameterError, match="--command-scale"):
        prepare(odd, Options())
    back = prepare(odd, Options(command_scale=1e-3))[0]
    np.testing.assert_allclose(back.command, log.command)


def test_logs_one_after_the_other_are_taken_apart() -> None:
    """Two runs in one file, the second with an earlier clock, and a stub."""
    first, second = swing("sine", seconds=3.0), swing("step", seconds=3.5)
    stub = first.between(0.0, 0.5)
    both = Recording(
        "both",
        np.concatenate((first.time + 100.0, second.time, stub.time + 50.0)),
        np.concatenate((first.measured, second.measured, stub.measured)),
        np.concatenate((first.command_time + 100.0, second.command_time)),
        np.concatenate((first.command, second.command)),
    )
    found, findings = pieces(both)
    assert [each.name for each in found] == ["both (1)", "both (2)"]
    np.testing.assert_array_equal(found[0].command, first.command)
    np.testing.assert_array_equal(found[1].command_time, second.command_time)
    assert "2 of 3 pieces used" in findings[0]
    assert pieces(first) == ([first], [])


def test_a_log_begun_in_motion_is_followed() -> None:
    """Its state at the start is fitted, and the command before the first is no 0 V."""
    log = swing("sine").between(1.0, np.inf)
    ready, findings = prepare(log, Options())
    assert ready.commanded_at(ready.time[:1]) != 0.0
    assert any("in motion from the start" in each for each in findings)


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
