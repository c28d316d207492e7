"""Identification from simulated recordings: a balanced pendulum and a swinging one."""

from __future__ import annotations

import numpy as np
import pytest
from rig_log import Truth, swing

from furuta_control.control import ControllerParameters
from furuta_control.estimation import EstimatorParameters
from furuta_control.excitation import ExcitationParameters
from furuta_hw.rigs.rig import Rig
from furuta_identification.identify import identify
from furuta_identification.model import Model
from furuta_identification.options import Options
from furuta_identification.preparation.prepare import prepare, prepare_all
from furuta_identification.regression.first_estimate import first_estimate, momentum_fit
from furuta_identification.regression.speeds import speed_lag, with_speeds
from furuta_identification.result.identified_rig import identified_rig
from furuta_identification.result.report import standard_errors, summary
from furuta_identification.result.validation import validate
from furuta_identification.shooting.optimisation import fit_percent
from furuta_identification.uncertainty.identifiability import undetermined
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError
from furuta_model.parts.converter import drive
from furuta_model.sensors import Sensors
from furuta_recordings.recording import Recording
from furuta_recordings.splitting import split_into_runs
from furuta_sim.parameters import PlantFriction, PlantParameters
from furuta_sim.plant import NOISE_CHANNELS, measure
from furuta_sim.simulation.closed_loop import Loop, simulate

PAPER = {"a23": -11.0, "a43": 33.0, "b21": 45.0, "b41": -29.0}


def balanced(
    seconds: float, ideal: bool, seed: int = 0, excitation: ExcitationParameters | None = None
) -> Recording:
    """A closed-loop recording of the simulated rig: sensor values and the drive's voltage."""
    friction = PlantFriction(parameters=Friction(asymmetry=0.1))
    plant = PlantParameters(friction=friction, sensors=Sensors(ideal=ideal), seed=seed)
    estimator = EstimatorParameters(sensors=Sensors(ideal=ideal))
    controller = ControllerParameters(excitation=excitation or ExcitationParameters())
    run = simulate(Loop(plant=plant, estimator=estimator, controller=controller), seconds)
    noise = np.random.default_rng(seed).standard_normal((len(run.command), NOISE_CHANNELS))
    measured = np.empty((len(run.command), 4))
    for row, x, errors in zip(measured, run.state, noise, strict=True):
        measure(x, errors, plant.sensors, row)
    command = np.array([drive(u, plant.actuator) for u in run.command])
    return Recording("balanced", run.time, measured, run.time, command)


def test_coefficients_of_the_paper_from_ideal_sensors() -> None:
    """a23, a43, b21, b41 and the Coulomb level within 0.1 %."""
    found = summary(identify([balanced(5.0, ideal=True)], Options()))
    assert {name: found[name] for name in PAPER} == pytest.approx(PAPER, rel=1e-3)
    assert found["coulomb"] == pytest.approx(0.21, rel=1e-3)
    assert found["asymmetry"] == pytest.approx(0.1, rel=1e-3)


@pytest.fixture(scope="module")
def undriven() -> Model:
    """The model from a limit cycle with the paper's sensors."""
    return identify([balanced(20.0, ideal=False)], Options())


def test_coefficients_of_the_paper_from_the_closed_loop(undriven: Model) -> None:
    """The same with the paper's sensors; the truth lies within four standard errors."""
    found, errors = summary(undriven), standard_errors(undriven)
    assert {name: found[name] for name in PAPER} == pytest.approx(PAPER, rel=0.03)
    assert found["coulomb"] == pytest.approx(0.21, rel=0.05)
    assert found["asymmetry"] == pytest.approx(0.1, rel=0.05)
    for name, truth in PAPER.items():
        assert abs(found[name] - truth) < 4.0 * errors[name]


def test_excitation_reduces_the_errors(undriven: Model) -> None:
    """A driven recording of half the length has smaller errors, at most half for a23."""
    excitation = ExcitationParameters("multisine", amplitude=1.0)
    driven = identify([balanced(10.0, ideal=False, excitation=excitation)], Options())
    before, after, found = standard_errors(undriven), standard_errors(driven), summary(driven)
    for name, truth in PAPER.items():
        assert after[name] < before[name]
        assert found[name] == pytest.approx(truth, rel=0.01)
    assert after["a23"] < before["a23"] / 2.0


@pytest.fixture(scope="module")
def usual() -> Recording:
    """A recording of a swinging pendulum."""
    return swing("sine")


@pytest.fixture(scope="module")
def swung(usual: Recording) -> Model:
    """The model of a swinging pendulum."""
    return identify([usual], Options())


def test_a_swinging_pendulum_with_the_faults_of_a_real_rig(swung: Model) -> None:
    """Inertias, friction, lag and tilt, although speeds lag and the base is tilted."""
    truth, values = Truth(), swung.values
    for name, relative in (("beta", 0.1), ("gamma", 0.1), ("delta", 0.1), ("viscous", 0.05)):
        assert values[name] == pytest.approx(getattr(truth, name), rel=relative)
    assert values.body.alpha == pytest.approx(truth.alpha, rel=0.2)
    assert values["coulomb"] == pytest.approx(truth.coulomb, rel=0.2)
    assert np.sqrt(values["delta"] / values["beta"]) == pytest.approx(
        np.sqrt(0.22 / 0.0025), rel=0.01
    )
    assert values["lag"] == pytest.approx(truth.lag, abs=5e-4)
    assert (values["tilt_x"], values["tilt_y"]) == pytest.approx(truth.tilt, abs=0.015)
    fits = swung.predict(swung.recordings[0]).fits()
    assert min(fits["arm speed"], fits["pendulum angle"]) > 90.0


def test_standard_errors_cover_the_truth(swung: Model) -> None:
    """The truth lies within four of them, and they are below 30 % of the value."""
    truth, model = Truth(), swung
    found, errors = summary(model), standard_errors(model)
    for name in ("beta", "gamma", "delta", "viscous"):
        assert abs(found[name] - getattr(truth, name)) < 4.0 * errors[name]
        assert errors[name] < 0.3 * getattr(truth, name)


def test_a_model_predicts_another_recording(swung: Model) -> None:
    """Fitted to the sine, simulated along a step whose first command was lost."""
    prediction, findings = validate(swung, swing("step"), Options())
    fits = prediction.fits(3.0)
    assert fits["arm speed"] > 80.0
    assert fits["pendulum angle"] > 70.0
    assert any("first command is missing" in finding for finding in findings)


def test_undetermined_parameters_are_withheld(swung: Model) -> None:
    """A fast swing does not determine the bristle's parameters: reasons instead of values."""
    found = summary(swung)
    for name in ("alpha1", "stribeck_velocity"):
        assert found["lugre"][name] is None
        assert name in undetermined(swung)
    rig, uncertainty = identified_rig(swung, Rig())
    assert rig.friction.stribeck_velocity == Rig().friction.stribeck_velocity
    assert rig.friction.alpha1 == 0.0
    assert uncertainty.standard_errors["stribeck_velocity"] >= 0.5


def test_orientation_is_detected(usual: Recording) -> None:
    """For every zero and direction of the pendulum's angle the result is that of (1)."""
    upright = prepare(usual, Options())[0]
    for zero, direction in ((0.0, 1.0), (np.pi, -1.0), (np.pi, 1.0), (0.0, -1.0)):
        back, findings = prepare(upright.reoriented(zero, direction, 1.0), Options())
        np.testing.assert_allclose(
            np.sin(back.measured[:, 2]), np.sin(upright.measured[:, 2]), atol=1e-9
        )
        assert any("(detected)" in finding for finding in findings)


def test_a_wrong_zero_is_refused(usual: Recording) -> None:
    """The motion contradicts the user."""
    with pytest.raises(ParameterError, match="as if its zero were hanging"):
        prepare(usual, Options(zero="upright"))


def test_regression_on_momenta(usual: Recording) -> None:
    """The first estimate alone: natural frequency within 2 %, lag within 1 ms."""
    assert speed_lag(usual) == pytest.approx(0.008, abs=1e-3)
    ready = prepare(usual, Options())[0]
    fit = momentum_fit(with_speeds(ready, speed_lag(ready)))
    assert np.sqrt(fit.delta / fit.beta) == pytest.approx(np.sqrt(0.22 / 0.0025), rel=0.02)
    assert fit.viscous == pytest.approx(0.25, rel=0.1)


def test_units_signs_and_clock_of_another_rig(usual: Recording) -> None:
    """Degrees, rpm, an inverted motor, commands logged 50 ms late: the same first estimate."""
    odd = usual._replace(
        measured=usual.measured * np.array([180 / np.pi, 30 / np.pi, 180 / np.pi, -30 / np.pi]),
        command=-usual.command,
        command_time=usual.command_time + 0.05,
    )
    (ready,), findings = prepare_all([odd], Options())[::3]
    remarks = " ".join(findings)
    for words in ("in deg (detected)", "arm's speed is in rpm", "has the opposite sign"):
        assert words in remarks
    expected = first_estimate([prepare(usual, Options())[0]], Truth().lag)
    estimate = first_estimate([ready], Truth().lag)
    assert estimate.negated and not expected.negated
    assert estimate.delay == pytest.approx(Truth().delay - 0.05, abs=0.015)
    for name in ("beta", "gamma", "delta", "viscous"):
        usual_value = getattr(expected.regression, name)
        assert getattr(estimate.regression, name) == pytest.approx(usual_value, rel=0.1)


def test_a_speed_that_does_not_match_its_angle_is_ignored(usual: Recording) -> None:
    """A speed that is not the slope of its angle in any unit becomes NaN."""
    odd = usual._replace(measured=usual.measured * [1, 2.0, 1, 1])
    ready, findings = prepare(odd, Options())
    assert np.all(np.isnan(ready.measured[:, 1]))
    assert any("arm's speed is not the slope of its angle" in finding for finding in findings)


def test_commands_that_cannot_be_volts_are_refused(usual: Recording) -> None:
    """Millivolts need --command-scale."""
    odd = usual._replace(command=1000.0 * usual.command)
    with pytest.raises(ParameterError, match="--command-scale"):
        prepare(odd, Options())
    back = prepare(odd, Options(command_scale=1e-3))[0]
    np.testing.assert_allclose(back.command, usual.command)


def test_several_runs_in_one_log_are_split(usual: Recording) -> None:
    """Two runs in one file, the second with an earlier clock, and a run that is too short."""
    first, second = usual.between(0.0, 3.0), usual
    short = first.between(0.0, 0.5)
    both = Recording(
        "both",
        np.concatenate((first.time + 100.0, second.time, short.time + 50.0)),
        np.concatenate((first.measured, second.measured, short.measured)),
        np.concatenate((first.command_time + 100.0, second.command_time)),
        np.concatenate((first.command, second.command)),
    )
    runs, findings = split_into_runs(both)
    assert [run.name for run in runs] == ["both (1)", "both (2)"]
    np.testing.assert_array_equal(runs[0].command, first.command)
    np.testing.assert_array_equal(runs[1].command_time, second.command_time)
    assert "2 of 3 runs used" in findings[0]
    assert split_into_runs(first) == ([first], [])


def test_a_log_that_starts_in_motion(usual: Recording) -> None:
    """The first command is assumed to have held before, not 0 V."""
    log = usual.between(1.0, np.inf)
    ready, findings = prepare(log, Options())
    assert ready.commanded_at(ready.time[:1]) != 0.0
    assert any("in motion at the start" in finding for finding in findings)


def test_dropouts_are_interpolated_and_reported(usual: Recording) -> None:
    """A gap, missing speeds and a missing angle."""
    keep = np.abs(usual.time - 2.0) > 0.05
    measured = usual.measured.copy()
    measured[500:520, 1] = np.nan
    measured[700, 0] = np.nan
    gappy = usual._replace(time=usual.time[keep], measured=measured[keep])
    ready, findings = prepare(gappy, Options())
    assert np.all(np.isfinite(ready.measured))
    assert any("dropout of 0.1" in finding for finding in findings)
    assert any(f"1 of {np.sum(keep)} samples dropped" in finding for finding in findings)


def test_incomplete_recordings_are_refused(usual: Recording) -> None:
    """The message says what is missing."""
    without_command = usual._replace(command=np.zeros(0), command_time=np.zeros(0))
    with pytest.raises(ParameterError, match="no command in it"):
        prepare(without_command, Options())
    without_angle = usual._replace(measured=np.full(usual.measured.shape, np.nan))
    with pytest.raises(ParameterError, match="no angle of the arm"):
        prepare(without_angle, Options())


def test_fit_percent() -> None:
    """100 for a perfect prediction, 0 for the mean, NaN for a constant series."""
    y = np.sin(np.arange(100.0))
    assert fit_percent(y, y) == 100.0
    assert fit_percent(y, np.full(100, y.mean())) == pytest.approx(0.0)
    assert np.isnan(fit_percent(np.ones(10), np.ones(10)))
