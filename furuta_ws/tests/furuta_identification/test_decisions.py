"""What is found in a recording: sure decisions, waves, ceilings, verdicts, excerpts."""

from __future__ import annotations

import numpy as np
import pytest
from random_rigs import Readings, Rig, record

from furuta_control.estimation import EstimatorParameters
from furuta_hw.rigs import rig
from furuta_identification.identify import identify
from furuta_identification.model import Model, Prediction
from furuta_identification.options import Options
from furuta_identification.preparation.prepare import prepare, prepare_all
from furuta_identification.regression.autocorrelation import coloured_part
from furuta_identification.regression.ceiling import fitted_ceiling, what_hides_a_ceiling
from furuta_identification.regression.speeds import speed_lag, with_speeds
from furuta_identification.result.identified_rig import identified_rig
from furuta_identification.result.report import summary
from furuta_identification.result.validation import validate
from furuta_identification.result.verdict import verdict
from furuta_identification.shooting.unknowns import wave_names
from furuta_identification.uncertainty.identifiability import undetermined
from furuta_model.parameters import ParameterError
from furuta_model.sensors import Sensors
from furuta_model.state import THETA
from furuta_recordings.recording import Recording
from furuta_recordings.splitting import EXCERPT, EXCERPTS, excerpts_of
from furuta_sim.parameters import PlantParameters
from furuta_sim.simulation.closed_loop import Loop, simulate

DEGREE = np.pi / 180.0
WAVES = np.array([[1.0, 0.01, 0.0], [5.0, 0.06, 0.05]])
RIG = Rig(
    0.0075, 0.0025, 0.002, 0.22, 0.25, 0.13, 0.11, 4e-4, WAVES, -0.03, 0.02, 3.0, 0.003, 0.006
)

USUAL = Readings()


def recorded(
    kind: str, amplitude: float, readings: Readings = USUAL, seconds: float = 5.0
) -> Recording:
    rng = np.random.default_rng(len(kind))
    return record(RIG, kind, amplitude, seconds, readings, rng, kind)


def test_recordings_of_one_call_share_units() -> None:
    """A small swing alone does not tell degrees from radians; beside a large one it does."""
    small = recorded("steps", 0.3, Readings(DEGREE, DEGREE))
    small = small._replace(measured=small.measured / np.ptp(small.measured[:, THETA]))
    with pytest.raises(ParameterError, match="--angles"):
        prepare(small, Options())
    large = recorded("steps", 2.5, Readings(DEGREE, DEGREE))
    assert prepare_all([small, large], Options()).angles == "deg"
    assert prepare_all([recorded("sine", 0.5), recorded("steps", 2.5)], Options()).angles == "rad"


def test_times_since_1970_give_the_same_speeds() -> None:
    """Squares of such times have no digits left for the intervals."""
    recording = recorded("multisine", 1.0)
    recording.measured[:, THETA + 1] = np.nan
    late = recording._replace(time=recording.time + 1.7e9)
    found, later = (with_speeds(each, 0.0).measured[:, THETA + 1] for each in (recording, late))
    np.testing.assert_allclose(later, found, atol=1e-3 * np.max(np.abs(found)))


def test_a_small_swing_in_radians_stays_in_radians() -> None:
    """Gravity's sine hardly shows in it."""
    assert prepare_all([recorded("sine", 1.0)], Options()).angles == "rad"


def test_an_odd_zero_asks_for_its_option() -> None:
    """A zero at 90° is not guessed; the option accepts the angle of the hanging pendulum."""
    odd = recorded("steps", 2.5).reoriented(0.5 * np.pi, 1.0, 1.0)
    with pytest.raises(ParameterError, match=r"hang at a measured angle of 90°; .*--zero"):
        prepare(odd, Options())
    ready, findings = prepare(odd, Options(zero=0.5 * np.pi))
    assert np.cos(ready.measured[0, THETA]) == pytest.approx(-1.0, abs=0.01)
    assert "90° from hanging" in findings[-1]


def test_a_direction_that_the_motion_does_not_show() -> None:
    """It is that of the other recordings, or asked."""
    rig = RIG._replace(gamma=1e-5)
    apart = record(rig, "steps", 2.5, 5.0, USUAL, np.random.default_rng(0), "apart")
    with pytest.raises(ParameterError, match="--direction"):
        prepare(apart, Options())
    both = prepare_all([apart, recorded("steps", 2.5)], Options())
    assert "that of the other" in " ".join(both.findings)
    given = prepare_all([apart], Options(direction=-1.0))
    assert given.direction == -1.0


@pytest.mark.parametrize(("amplitude", "expected"), [(4.5, 3.0), (2.5, np.inf)])
def test_the_ceiling_shows_in_larger_commands(amplitude: float, expected: float) -> None:
    """Within 5 %, and none where the drive does not reach it."""
    ready, _ = prepare(recorded("chirp", amplitude), Options())
    found = fitted_ceiling([ready], speed_lag(ready), 0.003)
    assert found == pytest.approx(expected, rel=0.05)


def test_a_step_does_not_show_the_ceiling() -> None:
    """A finding says so, unless a recording has another level."""
    step, sine = recorded("step", 4.0), recorded("sine", 2.0)
    for hidden in ([step], [step, recorded("step", 4.0)]):
        assert "--ceiling" in what_hides_a_ceiling(hidden)[0]
    for shown in ([sine], [step, recorded("step", 2.0)]):
        assert what_hides_a_ceiling(shown) == []


@pytest.fixture(scope="module")
def model() -> Model:
    """The model of two recordings whose zeros differ."""
    return identify(
        [recorded("steps", 2.5, seconds=3.0), recorded("sine", 2.0, Readings(zero=0.1), 3.0)],
        Options(),
    )


def test_waves_and_zeros(model: Model) -> None:
    """The order of the torque's wave, its amplitudes, and the zero of each recording."""
    found = summary(model)
    assert 5 in [wave["order"] for wave in found["waves"]]
    amplitudes = [model.values[name] for name in wave_names(5)]
    assert amplitudes == pytest.approx(WAVES[1, 1:], abs=0.015)
    zeros = list(found["setup"]["zeros"].values())
    assert zeros[0] - zeros[1] == pytest.approx(0.1, abs=0.005)
    assert found["setup"]["ceiling"] is None
    assert found["natural_frequency_rad_s"] == pytest.approx(np.sqrt(0.22 / 0.0025), rel=0.005)


def test_a_held_out_recording_has_its_own_ceiling(model: Model) -> None:
    """Commands beyond those of the fit meet the drive's ceiling, which is reported."""
    prediction, findings = validate(model, recorded("steps", 5.0, seconds=3.0), Options())
    reached = float(findings[-1].split("the drive reaches ")[1].split()[0])
    assert reached == pytest.approx(RIG.ceiling, rel=0.03)
    assert prediction.fits(2.0)["arm speed"] > 90.0
    blind, findings = validate(
        model, recorded("steps", 2.4, Readings(zero=0.1, hanging=False), 3.0), Options()
    )
    assert not any("ceiling" in each for each in findings)
    assert blind.fits(2.0)["pendulum angle"] > 90.0


def test_a_balanced_recording_stays_upright(model: Model) -> None:
    """Its rest is not taken for a hanging pendulum with another zero."""
    sensors = Sensors(ideal=True)
    plant, estimator = PlantParameters(sensors=sensors), EstimatorParameters(sensors=sensors)
    run = simulate(Loop(plant=plant, estimator=estimator), 3.0)
    log = Recording("upright", run.time, run.state[:, :4], run.time, run.command)
    prediction, findings = validate(model, log, Options())
    assert np.max(np.abs(prediction.recording.measured[:, THETA])) < 0.7
    assert not any("zero differs" in each for each in findings)


def test_the_verdict_looks_at_the_arm(model: Model) -> None:
    """A model whose arm does not follow is not usable, however well the pendulum does."""
    good = [model.predict(recording) for recording in model.recordings]
    assert verdict(good)["usable"] == "yes"
    wrong = good[0].predicted.copy()
    wrong[:, :2] = 0.0
    found = verdict([Prediction(good[0].recording, wrong)])
    assert found["usable"] == "no"
    assert "fit of the arm" in found["reasons"][0]


def test_a_value_at_the_end_of_its_range_is_no_result(model: Model) -> None:
    """It is withheld, and no rig file holds it."""
    odd = model._replace(values=model.values.changed(["asymmetry"], [-0.95]))
    assert "end of the allowed range" in undetermined(odd)["asymmetry"]
    assert summary(odd)["asymmetry"] is None
    found, _ = identified_rig(odd, rig.Rig())
    assert found.friction.asymmetry == 0.0


def test_coloured_part() -> None:
    """About 5 % for white noise, most for a random walk."""
    noise = np.random.default_rng(0).standard_normal((40, 2000))
    assert np.mean([coloured_part(each) for each in noise]) == pytest.approx(5.0, abs=2.0)
    assert coloured_part(np.cumsum(noise[0])) > 90.0


def test_long_recordings_are_fitted_in_excerpts() -> None:
    """Excerpts with the commands that hold in them; without parts in which the arm rests."""
    time = np.arange(100_000) * 5e-4
    measured = np.column_stack([np.sin(3.0 * time)] * 4)
    measured[time < 10.0] = 0.0
    log = Recording("long", time, measured, time[::10], np.arange(10_000.0))
    assert excerpts_of(log, 100_000) == ([log], [])
    found, findings = excerpts_of(log, 30_000)
    assert len(found) == EXCERPTS
    for each in found:
        assert len(each.time) == EXCERPT
        assert each.interval == pytest.approx(1e-3)
        assert each.time[0] >= 9.0
        np.testing.assert_array_equal(each.commanded_at(each.time), log.commanded_at(each.time))
    assert "excerpts of 2.0 s of 50.0 s" in findings[0]
