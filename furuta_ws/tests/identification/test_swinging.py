"""The model of a swinging pendulum: truth, standard errors, verdict, predictions, rig."""

from pathlib import Path

import numpy as np
import pytest
from random_rigs import EXAMPLE, Readings, example, record
from sources import RECORDINGS

import furuta
from furuta.identification.identify import identify, validate
from furuta.identification.least_squares import Fit
from furuta.identification.model import Model, Prediction
from furuta.identification.options import Options
from furuta.identification.result.identified_rig import (
    _recorded_rig,
    _rig_of_plant,
    identified_rig,
    quadratic_poles,
)
from furuta.identification.result.rig_friction import rig_friction
from furuta.identification.result.values import standard_errors, values_by_name, verdict
from furuta.identification.shooting.optimisation import optimise
from furuta.identification.shooting.unknowns import BODY, wave
from furuta.identification.uncertainty import covariance
from furuta.identification.uncertainty.identifiability import undetermined
from furuta.results.rig_models import RigModel
from furuta_control.estimation import EstimatorParameters
from furuta_hw.rigs.rig import Rig
from furuta_model.linear import linearize, place_poles
from furuta_model.parameters import ParameterError
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors
from furuta_model.state import THETA
from furuta_recordings.recording import Recording
from furuta_sim.parameters import PlantParameters
from furuta_sim.simulation.closed_loop import Loop, simulate

SMALL = FurutaPendulum(0.006, 0.0024, 0.0019, 0.21)
# A recording of a public rig, if it is there.
SINE = RECORDINGS / "hardware_sin_response_2V_1s.csv"


@pytest.fixture(scope="module")
def model() -> Model:
    """The model of two recordings whose zeros differ."""
    other = Readings(zero=0.1)
    recordings = [example("steps", 2.5, seconds=3.0), example("sine", 2.0, other, seconds=3.0)]
    return identify(recordings, Options())


def test_the_truth(model: Model) -> None:
    values = model.values
    for name in ("beta", "gamma", "delta", "viscous"):
        assert values[name] == pytest.approx(getattr(EXAMPLE, name), rel=0.05)
    assert values.body.alpha == pytest.approx(EXAMPLE.alpha, rel=0.1)
    assert values["coulomb"] == pytest.approx(0.12, rel=0.2)
    assert values["lag"] == pytest.approx(EXAMPLE.lag, abs=5e-4)
    tilt = (EXAMPLE.tilt_x, EXAMPLE.tilt_y)
    assert (values["tilt_x"], values["tilt_y"]) == pytest.approx(tilt, abs=0.015)
    for recording in model.recordings:
        fits = model.predict(recording).fits()
        assert min(fits["arm speed"], fits["pendulum angle"]) > 90.0


def test_standard_errors_cover_the_truth(model: Model) -> None:
    values, errors = values_by_name(model), standard_errors(model)
    for name in ("alpha", "beta", "gamma", "delta", "viscous"):
        truth = getattr(EXAMPLE, name)
        assert abs(values[name] - truth) < 4.0 * errors[name]
        assert errors[name] < 0.3 * truth


def test_friction_over_speed(model: Model) -> None:
    """The voltage shows the friction of the fitted law, beside waves and tilt."""
    curve = rig_friction(model)
    law = np.interp(curve.measured_speed, curve.speed, curve.law)
    true = 0.12 * np.sign(curve.speed) + EXAMPLE.viscous * curve.speed
    assert np.max(np.abs(curve.law - true)) < 0.05 * np.ptp(true)
    assert np.sqrt(np.mean((curve.measured - law) ** 2)) < 0.05 * np.ptp(law)
    assert len(curve.measured) >= 4


def test_waves_and_zeros(model: Model) -> None:
    report = values_by_name(model)
    assert 5 in [wave["order"] for wave in report["waves"]]
    amplitudes = [model.values[key] for key in wave(5)]
    assert amplitudes == pytest.approx(EXAMPLE.waves[1, 1:], abs=0.015)
    zeros = list(report["setup"]["zeros"].values())
    assert zeros[0] - zeros[1] == pytest.approx(0.1, abs=0.005)
    assert report["setup"]["ceiling"] is None
    assert report["natural_frequency_rad_s"] == pytest.approx(np.sqrt(0.22 / 0.0025), rel=0.005)


def test_a_model_predicts_another_recording(model: Model) -> None:
    lost = Readings(first_missing=True)
    prediction = validate(model, example("step", 2.4, lost), Options())
    fits = prediction.fits(3.0)
    assert fits["arm speed"] > 90.0
    assert fits["pendulum angle"] > 70.0
    assert any("first command is missing" in finding for finding in prediction.recording.findings)


@pytest.mark.parametrize("clips", [True, False])
def test_a_held_out_recording_shows_that_the_drive_clips(model: Model, clips: bool) -> None:
    """If commands beyond all fitted ones do too little, the ceiling that explains it is named."""
    rig = EXAMPLE._replace(ceiling=3.2 if clips else 12.0)
    rng = np.random.default_rng(3)
    prediction = validate(model, record(rig, "step", 4.0, 3.0, Readings(), rng), Options())
    # A ceiling that the held-out recording suggests is not part of its prediction.
    assert (prediction.fits()["arm angle"] > 95.0) == (not clips)
    said = " ".join(prediction.recording.findings)
    assert ("may clip at" in said) == clips
    if clips:
        ceiling = float(said.partition("give --ceiling ")[2].split(";")[0])
        assert ceiling == pytest.approx(rig.ceiling, rel=0.03)


def test_what_depends_on_an_undetermined_value_is_withheld(model: Model) -> None:
    """Derived values have the errors of all that they depend on."""
    covariance = model.covariance.copy()
    arm = model.keys.index("arm_inertia")
    covariance[arm, arm] = 4.0
    report = values_by_name(model._replace(covariance=covariance))
    for name in ("alpha", "a23", "b21", "b41"):
        assert report[name] is None
        assert report["standard_errors"][name] is None
        assert "mostly from arm_inertia" in report["undetermined"][name]
    assert report["beta"] is not None
    assert report["natural_frequency_rad_s"] is not None
    covariance[:] = model.covariance
    viscous = model.keys.index("viscous")
    covariance[viscous, viscous] = 1.0
    assert values_by_name(model._replace(covariance=covariance))["viscous"] is None


def test_a_balanced_recording_stays_upright(model: Model) -> None:
    """Its rest is not taken for a hanging pendulum with another zero."""
    sensors = Sensors(ideal=True)
    plant, estimator = PlantParameters(sensors=sensors), EstimatorParameters(sensors=sensors)
    run = simulate(Loop(plant=plant, estimator=estimator), 3.0)
    log = Recording("upright", run.time, run.state[:, :4], run.time, run.command)
    prediction = validate(model, log, Options())
    assert np.max(np.abs(prediction.recording.measured[:, THETA])) < 0.7
    assert not any("zero differs" in finding for finding in prediction.recording.findings)


def test_undetermined_parameters_are_withheld(model: Model) -> None:
    report = values_by_name(model)
    for name in ("alpha1", "stribeck_velocity"):
        assert report["lugre"][name] is None
        assert name in undetermined(model)
    rig, uncertainty = identified_rig(model, Rig())
    assert rig.friction.stribeck_velocity == Rig().friction.stribeck_velocity
    assert rig.friction.alpha1 == 0.0
    assert uncertainty.standard_errors["stribeck_velocity"] >= 0.5


def test_a_value_at_the_end_of_its_range_is_no_result(model: Model) -> None:
    odd = model._replace(values=model.values.changed(["asymmetry"], [-0.95]))
    assert "end of the allowed range" in undetermined(odd)["asymmetry"]
    assert values_by_name(odd)["asymmetry"] is None
    rig, _ = identified_rig(odd, Rig())
    assert rig.friction.asymmetry == 0.0


def test_errors_beyond_all_bodies_are_not_linear(
    model: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A body whose inertia is almost 0 cannot be simulated."""
    found = (model.values, model.window, model.scale)
    optimum = optimise(model.recordings, BODY, *found, robust=False)
    assert covariance.is_linear(optimum)
    monkeypatch.setattr(Fit, "covariance", 1e6 * np.eye(len(BODY)))
    assert not covariance.is_linear(optimum)


def test_the_verdict_looks_at_the_arm(model: Model) -> None:
    good = [model.predict(recording) for recording in model.recordings]
    assert verdict(good).usable == "yes"
    wrong = good[0].predicted.copy()
    wrong[:, :2] = 0.0
    judged = verdict([Prediction(good[0].recording, wrong)])
    assert judged.usable == "no"
    assert "fit of the arm" in judged.reasons[0]


def test_coloured_residuals_are_doubtful(model: Model) -> None:
    """They are an error of the model; noise of the same size is one of the sensors."""
    recording = model.recordings[0]
    size = 0.1 * np.std(recording.measured[:, THETA])
    noise = np.random.default_rng(1).standard_normal(len(recording.time))
    for error, usable in ((noise, "yes"), (np.sqrt(2.0) * np.sin(recording.time), "doubtful")):
        wrong = recording.measured.copy()
        wrong[:, THETA] += size * error
        judged = verdict([Prediction(recording, wrong)])
        assert judged.usable == usable
        assert ("coloured" in str(judged.reasons)) == (usable == "doubtful")


def test_the_delay_is_not_negative(model: Model) -> None:
    """It is withheld if the commands are logged after they act."""
    report = values_by_name(model)
    assert report["setup"]["delay"] >= 0.0
    assert abs(report["setup"]["delay"] - EXAMPLE.delay) < 3.0 * report["standard_errors"]["delay"]
    late = values_by_name(model._replace(command_delay=-0.02))
    assert late["setup"]["delay"] is None
    assert "logged later" in late["undetermined"]["delay"]


@pytest.mark.parametrize(("model", "viscous"), [(FurutaPendulum(), 0.0), (SMALL, 0.25)])
def test_the_poles_are_those_of_the_optimal_loop(model: FurutaPendulum, viscous: float) -> None:
    """The stable eigenvalues of the Hamiltonian, with 2 V/rad at a drive of 10 V."""
    a, b = linearize(model, viscous)
    hamiltonian = np.block([[a, -np.outer(b, b)], [-np.diag([4.0, 0, 0, 0]), -a.T]])
    optimal = [pole for pole in np.linalg.eigvals(hamiltonian) if pole.real < 0.0]
    poles = quadratic_poles(model, viscous, 10.0)
    assert poles.polynomial == pytest.approx(np.poly(optimal).real, rel=1e-6)
    # An optimal loop stands half and any multiple of its torque.
    gain = place_poles(model, poles, viscous)
    for factor in (0.51, 1.0, 5.0):
        assert np.linalg.eigvals(a - factor * np.outer(b, gain)).real.max() < 0.0


@pytest.mark.long
@pytest.mark.skipif(not SINE.exists(), reason="FURUTA_RECORDINGS has no such record")
def test_a_real_rig() -> None:
    """One recording of a public rig predicts another one, whose first command is missing."""
    step = RECORDINGS / "hardware_step_response_4V.csv"
    names = {"arm": "joint0", "pendulum": "joint1", "command": "effort_control"}
    driven, held_out = (furuta.read_recording(each, **names) for each in (SINE, step))
    model = furuta.identify(driven, furuta.PendulumBody(zero="hanging", validate=[held_out]))
    assert isinstance(model, RigModel)
    assert model.to_dict()["natural_frequency_rad_s"] == pytest.approx(9.35, rel=0.01)
    assert model.verdict.usable == "yes"
    for (prediction,), least in ((model.fitted, 98.0), (model.held_out, 96.0)):
        fits = prediction.fits()
        assert min(fits["arm angle"], fits["pendulum angle"]) > least


BRIDGE = "left/hardware_bridge: {{ros__parameters: {{rig: '{}'}}}}"


@pytest.mark.parametrize(
    ("parameters", "origin", "sample_time"),
    [
        (None, "sensors are not known", 0.002),
        ("controller: {ros__parameters: {strength: 1.0}}", "sensors are not known", 0.002),
        (BRIDGE.format("gone.yaml"), "gone.yaml is gone", 0.002),
        (BRIDGE.format("{rig}"), "(according to the bag)", 0.02),
        ("plant: {ros__parameters: {sample_time: 0.01}}", "according to the bag", 0.01),
    ],
    ids=["no file", "no plant", "gone", "rig", "plant"],
)
def test_a_recording_knows_its_sensors(
    parameters: str | None, origin: str, sample_time: float, tmp_path: Path
) -> None:
    """By the parameters in the bag, in a namespace too; else they are those of the paper."""
    rig = tmp_path / "rig.yaml"
    rig.write_text("line: {sample_time: 0.02}")
    if parameters:
        (tmp_path / "parameters.yaml").write_text(parameters.replace("{rig}", str(rig)))
    found, said = _recorded_rig(tmp_path, example("steps", 1.0, seconds=0.5))
    assert origin in said
    assert found.line.sample_time == sample_time


@pytest.mark.parametrize(
    "parameters",
    [
        BRIDGE.format("{rig}"),
        "plant: {ros__parameters: {sensors.tachometer_bits: twelve}}",
        "plant: [1, 2",
    ],
    ids=["rig file", "value", "text"],
)
def test_bad_parameters_in_a_bag_are_an_error(parameters: str, tmp_path: Path) -> None:
    """They are not replaced by the sensors of the paper."""
    rig = tmp_path / "rig.yaml"
    rig.write_text("line: {sample_tme: 0.02}")
    (tmp_path / "parameters.yaml").write_text(parameters.replace("{rig}", str(rig)))
    with pytest.raises(ParameterError, match=r"sample_tme|tachometer_bits|parameters.yaml"):
        _recorded_rig(tmp_path, example("steps", 1.0, seconds=0.5))


def test_a_converter_without_steps_is_written_with_the_most_bits() -> None:
    """Zero bits of a simulated converter mean no steps, not the coarsest ones."""
    given = {"actuator.bits": 0, "actuator.voltage_range": 10.0, "sensors.encoder_counts": 0}
    rig = _rig_of_plant(given | {"sample_time": 0.001})
    assert (rig.drive.bits, rig.speed.bits, rig.arm.counts_per_turn) == (16, 12, 200_000)
