"""A single axis, identified from its position and torque."""

from dataclasses import replace

import numpy as np
import pytest
from driven_axes import driven_axis
from sources import RECORDINGS
from true_axes import TrueAxis, multisine, recorded

from furuta.axis.draws import drawn_axes
from furuta.identification.axis.fit import AxisFit
from furuta.identification.axis.friction_curve import axis_followed, axis_friction
from furuta.identification.axis.identify import identify_axis
from furuta.identification.axis.motion import level
from furuta.identification.bodies.axis import model_of
from furuta.identification.verdict import Verdict
from furuta_model.parameters import ParameterError
from furuta_recordings.readers import read_axis
from furuta_recordings.recording import Recording

# The public training record of the positioning system EMPS, if it is there.
EMPS = RECORDINGS / "emps_train.csv"
FORCE_PER_VOLT = 35.15065  # published

PLAIN = TrueAxis(inertia=0.01, alpha0=0.1, viscous=0.02)
COUNT_4096 = 2.0 * np.pi / 4096


def sampled(
    axis: TrueAxis, size: float = 1.0, seconds: float = 10.0, rate: float = 500.0
) -> Recording:
    """A recording under a multisine, at a rate [Hz], by an encoder of 4096 counts."""
    time = np.arange(int(seconds * rate)) / rate
    noise = 6e-4 * size * np.random.default_rng(4).standard_normal(len(time))
    return recorded(axis, size * multisine(time, 0.6), 1.0 / rate, COUNT_4096, noise)


def assert_near(fit: AxisFit, axis: TrueAxis, **more: float) -> None:
    """Usable, and all reported values within three standard errors."""
    truth = {**axis.values(), **more}
    assert fit.usable == "yes", fit.reasons
    for name, value in fit.values.items():
        off = abs(value - truth.get(name, 0.0)) / fit.standard_errors[name]
        assert off < 3.0, (name, value, truth.get(name), off)


def test_everything_that_acts_is_found() -> None:
    """Delay, gravity, drag and a wave of the torque, and the right values beside them."""
    axis = PLAIN._replace(delay=0.0047, gravity_sin=0.1, gravity_cos=0.03, order=7.0, wave=0.03)
    axis = axis._replace(drag=0.002)
    fit = identify_axis(sampled(axis, size=2.0))
    assert_near(fit, axis)
    assert {"delay", "gravity_sin", "drag", "cos 7"} <= set(fit.values)


def test_a_torque_that_was_measured_acted_before_its_row() -> None:
    """The delay is that of a row, negative, and a finding; all else is as if it were commanded."""
    recording = sampled(PLAIN, size=2.0)
    before = np.append(recording.command[:1], recording.command[:-1])
    fit = identify_axis(recording._replace(command=before))
    assert_near(fit, PLAIN, delay=-1.0 / 500.0)
    assert any("the torque is recorded 2" in text for text in fit.findings)


def test_a_torque_that_never_changes_is_refused() -> None:
    recording = sampled(PLAIN)
    with pytest.raises(ParameterError, match="the torque is 0 throughout"):
        identify_axis(recording._replace(command=0.0 * recording.command))


def test_offset_and_drift_do_not_bias_the_axis() -> None:
    """A free run predicts another recording, with the offset that this one has."""
    axis = PLAIN._replace(offset=0.02, drift=0.004, viscous_difference=-0.004)
    fit = identify_axis(sampled(axis, size=2.0))
    assert_near(fit, axis, offset=axis.offset + 5.0 * axis.drift)
    assert {"drift", "viscous_difference"} <= set(fit.values)
    assert fit.resolution == pytest.approx(COUNT_4096)
    other = sampled(axis._replace(offset=-0.01, drift=0.0), seconds=4.0)
    assert fit.error(other, own_offset=True) < 0.1 * fit.error(other)


def test_friction_over_speed_is_the_true_one() -> None:
    """As the law and as the torque shows it, with gravity, delay, fall and offset beside it."""
    axis = PLAIN._replace(delay=0.0047, gravity_sin=0.1, offset=0.02)
    axis = axis._replace(alpha1=0.05, stribeck_velocity=0.5)
    fit = identify_axis(sampled(axis, size=2.0))
    curve = axis_friction(fit)

    def true(speed: np.ndarray) -> np.ndarray:
        level = axis.alpha0 + axis.alpha1 * np.exp(-((speed / axis.stribeck_velocity) ** 2))
        return np.sign(speed) * level + axis.viscous * speed + axis.offset

    assert np.all(np.abs(curve.law - true(curve.speed)) < 4.0 * curve.error)
    assert np.max(curve.error) < 0.05 * axis.alpha0
    assert np.ptp(curve.measured_speed) > 0.5 * np.ptp(curve.speed)
    off = curve.measured - true(curve.measured_speed)
    assert np.sqrt(np.mean(off**2)) < 0.05 * axis.alpha0
    assert curve.units == ("rad/s", "N m")
    followed = axis_followed(fit)
    left = followed.measured - followed.fitted
    noise = COUNT_4096 / np.sqrt(12.0)
    assert np.sqrt(np.nanmean(left**2)) == pytest.approx(noise, rel=0.1)


def test_one_direction_does_not_tell_friction_from_offset() -> None:
    time = np.arange(5000) / 500.0
    torque = 0.3 + multisine(time, 0.1)
    fit = identify_axis(recorded(PLAIN, torque, 0.002, COUNT_4096))
    assert fit.usable == "doubtful"
    assert "record reversals" in fit.reasons[-1]
    assert {"alpha0", "offset"} <= set(fit.undetermined)
    assert fit.values["inertia"] == pytest.approx(PLAIN.inertia, rel=0.05)


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize(
    "count", [2.0 * np.pi / 2**23, *(pytest.param(n, marks=pytest.mark.long) for n in (6e-6, 1e-9))]
)
def test_a_finer_encoder_tells_no_more_of_one_direction(count: float) -> None:
    """What it does not show stays unknown, however small the noise."""
    time = np.arange(5000) / 500.0
    fit = identify_axis(recorded(PLAIN, 0.3 + multisine(time, 0.1), 0.002, count))
    assert fit.usable == "doubtful"
    rounded = replace(fit, covariance=fit.covariance - 1e-7 * np.eye(len(fit.names)))
    assert len(drawn_axes(rounded, 3)) == 3
    assert {"alpha0", "offset", "asymmetry"} <= set(fit.undetermined)
    assert fit.values["inertia"] == pytest.approx(PLAIN.inertia, rel=0.01)


def test_records_without_information_are_refused() -> None:
    """No number comes without sensitivity: rest, and a torque of another axis."""
    moving = sampled(PLAIN, seconds=4.0)
    still = moving._replace(measured=np.zeros_like(moving.measured))
    reversed_ = moving._replace(command=-moving.command)
    for record, advice in ((still, "a larger motion"), (reversed_, "sign.* one joint alone")):
        with pytest.raises(ParameterError, match=advice) as caught:
            identify_axis(record)
        assert "\n" not in str(caught.value)


def test_nothing_is_invented() -> None:
    """A plain axis has its three values and an offset; stiction that is not there stays hidden."""
    fit = identify_axis(sampled(PLAIN))
    assert_near(fit, PLAIN)
    assert set(fit.values) == {"inertia", "alpha0", "viscous", "offset"}
    assert fit.hidden < 0.1 * PLAIN.alpha0


def test_stiction_that_is_over_at_once() -> None:
    """Its level is a value, its Stribeck velocity is not; a wave beside it is no gravity."""
    axis = PLAIN._replace(alpha1=0.04, stribeck_velocity=1e-9, spring=0.06, order=4.0, wave=0.02)
    fit = identify_axis(sampled(axis, size=2.0))
    assert_near(fit, axis)
    assert {"alpha1", "cos 4"} <= set(fit.values)
    assert "stribeck_velocity" in fit.undetermined and "gravity_sin" not in fit.values


@pytest.mark.long
def test_hunting_axis() -> None:
    """Friction that falls after breakaway is found at 1 kHz."""
    axis = TrueAxis(0.0025, 0.06, 0.004, alpha1=0.03, stribeck_velocity=0.05)
    fit = identify_axis(sampled(axis, size=0.8, seconds=20.0, rate=1000.0))
    assert_near(fit, axis)
    assert fit.values["alpha1"] > 5.0 * fit.standard_errors["alpha1"]


def test_friction_of_a_gear_under_load() -> None:
    """Friction in proportion to the torque of the drive is told from all other friction."""
    axis = PLAIN._replace(load_friction=0.1)
    fit = identify_axis(sampled(axis, size=2.0))
    assert_near(fit, axis)
    assert fit.values["load_friction"] > 5.0 * fit.standard_errors["load_friction"]


def test_what_the_model_does_not_have_is_doubtful() -> None:
    """Waves finer than those that are tried are no part of the model."""
    fit = identify_axis(sampled(PLAIN._replace(order=60.0, wave=0.1), size=2.0))
    assert fit.usable != "yes"
    assert any("something acts" in reason for reason in fit.reasons)


def test_a_wave_beside_drag_and_drift() -> None:
    """All three are found."""
    axis = PLAIN._replace(order=7.0, wave=0.03, drag=0.002, drift=0.004)
    fit = identify_axis(sampled(axis, size=2.0))
    assert fit.usable == "yes"
    assert {"cos 7", "drag", "drift"} <= set(fit.values)


def test_point_to_point_moves_are_explained() -> None:
    """Short moves under a PID, by a drive whose torque also ripples: none is refused."""
    for seed in (93, 130, 148):
        sample, _, recording = driven_axis(seed)
        fit, true = identify_axis(recording), sample.values()
        off = (fit.values["inertia"] - true["inertia"]) / fit.standard_errors["inertia"]
        assert abs(off) < 3.0


def test_how_friction_falls_is_open_if_the_model_leaves_more_than_noise() -> None:
    """Then a fall that was found may also be over at once, which decides on hunting."""
    fit = identify_axis(sampled(PLAIN._replace(alpha1=0.08, stribeck_velocity=0.3), size=2.0))
    assert {"alpha1", "stribeck_velocity"} <= set(fit.values)
    laws = {
        usable: [axis.law for axis in drawn_axes(replace(fit, verdict=Verdict(usable, [])))]
        for usable in ("yes", "doubtful")
    }
    assert set(laws["yes"]) == {"stribeck"}
    assert 30 < laws["doubtful"].count("stiction") < 70


def test_slow_joint_whose_torque_does_not_predict_its_motion() -> None:
    """Friction is fifteen times the torque that accelerates, errors of the torque are as large."""
    time = np.arange(2500) / 100.0
    parts = [(0.8, 0.9, 0.0), (0.2, 2.4, 1.0)]
    q, v, a = (
        sum(size * w**k * np.sin(w * time + phase + 0.5 * k * np.pi) for size, w, phase in parts)
        for k in range(3)
    )
    truth = {"inertia": 1.0, "alpha0": 14.0, "viscous": 9.0, "gravity_sin": 8.0, "offset": 0.3}
    torque = 1.0 * a + 14.0 * np.sign(v) + 9.0 * v + 8.0 * np.sin(q) + 0.3
    noise = np.random.default_rng(3).standard_normal(len(time))
    torque += 0.5 * np.cos(9.0 * q) * np.cos(0.37 * time) + 0.8 * noise
    measured = np.full((len(time), 4), np.nan)
    measured[:, 0] = 1e-4 * np.round(q / 1e-4)
    fit = identify_axis(Recording("joint", time, measured, time, torque))
    assert any("fitted to the torque" in finding for finding in fit.findings)
    assert fit.usable == "doubtful"
    # Over this travel a spring is not much worse than gravity, which is fitted but not sure.
    errors = np.sqrt(np.diag(fit.covariance))
    for name in ("inertia", "alpha0", "viscous", "gravity_sin"):
        error = errors[fit.names.index(name)]
        assert abs(fit.fit.values[name] - truth[name]) < 3.0 * error, name
        assert error < 0.3 * truth[name]
    assert fit.standard_errors["inertia"] < 0.3 * truth["inertia"]
    assert fit.values["alpha0"] == pytest.approx(14.0, rel=0.03)


def test_recordings_with_their_own_offsets() -> None:
    """Two recordings give one axis."""
    records = [sampled(PLAIN._replace(offset=offset), seconds=8.0) for offset in (0.02, -0.03)]
    fit = identify_axis(records)
    assert_near(fit, PLAIN._replace(offset=0.02), **{"offset 1": -0.03})
    assert "offset 1" in fit.values


def test_slow_and_irregular_samples() -> None:
    """50 Hz are enough; so are samples at any times."""
    assert_near(identify_axis(sampled(PLAIN, seconds=20.0, rate=50.0)), PLAIN)
    record = sampled(PLAIN)
    kept = np.sort(np.random.default_rng(5).permutation(len(record.time))[: len(record.time) // 3])
    assert_near(
        identify_axis(record._replace(time=record.time[kept], measured=record.measured[kept])),
        PLAIN,
    )


@pytest.mark.long
@pytest.mark.skipif(not EMPS.exists(), reason="FURUTA_RECORDINGS has no such record")
def test_published_drive() -> None:
    """Each half of EMPS's training record predicts the other, by the published force of friction.

    The published law is a line. The axis shows a curve, whose slope at rest is another value, so
    the force is compared over the speeds of the record.
    """
    whole = read_axis(EMPS, torque_constant=FORCE_PER_VOLT)
    middle = 0.5 * whole.duration
    first, second = whole.between(-np.inf, middle), whole.between(middle, np.inf)
    for known, held_out in ((first, second), (second, first)):
        fit = identify_axis(known)
        assert fit.values["inertia"] == pytest.approx(95.1, rel=0.02)
        law = model_of(fit.fit.values)
        for v in (0.02, 0.05, 0.1):
            force = level(v, 0.0, law) + law.viscous * v
            assert force == pytest.approx(20.39 + 203.5 * v, rel=0.04)
        # The errors of the values alone allow 5 mm. The axis travels 246 mm.
        assert fit.error(held_out, own_offset=True) < 2e-3
